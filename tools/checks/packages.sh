#!/bin/bash
# Judges the Debian packages of build/package/packages (tools/package makes them): lintian finds nothing, and in a bare
# Debian 12 each is installed by apt and used. As root, with mmdebstrap, lintian, appstream, desktop-file-utils and a
# mirror; about 2.5 GB in FOLDER.
#
# usage: tools/checks/packages.sh FOLDER [PACKAGES]     PACKAGES: the folder of the .deb files
#
# The mirror is $DEBIAN_MIRROR, or deb.debian.org.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
[[ $# -ge 1 && $# -le 2 ]] || { sed -n '2,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 2; }
folder=$1
packages=${2:-$root/build/package/packages}
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}

step() {
  local name=$1 start=$SECONDS
  shift
  if ! "$@" >"$folder/log" 2>&1; then
    echo "$name: failed"
    tail -n 30 "$folder/log"
    exit 1
  fi
  printf '%-48s ok %5d s\n' "$name" $((SECONDS - start))
}

bare() {
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    chroot "$folder/bare" "$@"
}

mkdir -p "$folder"
step "lintian" lintian --allow-root --fail-on error,warning "$packages"/*.deb
desktop=$root/tools/view/desktop
step "desktop entry" desktop-file-validate "$desktop/ivory-view.desktop"
step "AppStream" appstreamcli validate --no-net "$desktop/io.ivory.view.metainfo.xml"

rm -rf "$folder/bare"
step "a bare Debian 12" mmdebstrap --variant=apt --mode=root bookworm "$folder/bare" "deb $mirror bookworm main"
cp "$packages"/*.deb "$folder/bare/root/"
cp /etc/resolv.conf "$folder/bare/etc/"
step "apt update" bare apt-get update

# The program: the bake and the picture of tools/quickstart, smaller.
step "apt install ivory" bare sh -c 'apt-get install -y --no-install-recommends /root/ivory_*.deb'
scene=/usr/share/ivory/scenes/cornell_box.gltf
step "ivory bake grid" bare ivory bake grid $scene -o /root/box.vdb --resolution 8 --photons 100k
step "ivory render (OpenImageIO's module)" bare ivory render $scene --method direct --grid /root/box.vdb --samples 4 \
  --size 64x64 -o /root/box.exr -o /root/box.png
step "ivory bake difmap (reads an image)" bare ivory bake difmap /usr/share/ivory/scenes/sky.hdr --size 8 -o /root/sky.exr

step "apt install python3-ivory" bare sh -c 'apt-get install -y --no-install-recommends /root/python3-ivory_*.deb'
cat >"$folder/bare/root/use.py" <<'PYTHON'
import numpy as np, ivory
scene = ivory.Scene("/usr/share/ivory/scenes/cornell_box.gltf")
grid = scene.bake_grid(resolution=8, photons=100_000)
grid.write("/root/python.vdb")
assert open("/root/python.vdb", "rb").read() == open("/root/box.vdb", "rb").read()
assert grid.irradiance(np.full((10, 3), 0.2), (0, 1, 0)).min() > 0
ivory.write_image("/root/python.png", scene.render(width=16, height=12, samples=4))
PYTHON
step "python3: the same bytes as the command" bare python3 /root/use.py

step "apt install libivory-dev" bare sh -c 'apt-get install -y --no-install-recommends /root/libivory-dev_*.deb \
  cmake g++ make libglfw3-dev'
cp -r "$root/runtime/example" "$folder/bare/root/"
step "an engine is built against it" bare sh -c 'cmake -S /root/example -B /root/built && cmake --build /root/built'

step "apt remove" bare sh -c 'apt-get remove -y ivory && ! ls -d /usr/lib/python3/dist-packages/ivory /usr/lib/*/ivory 2>/dev/null'
