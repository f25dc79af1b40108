# shellcheck shell=bash
# Sourced by tools/quickstart and tools/test: brings the Debian packages of packages.txt.

# install_packages [MORE...]: installs what is missing. Needs root only when something is.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    echo "not a Debian system: taking it that what tools/packages.txt lists is installed" >&2
    return
  fi
  local package missing=()
  while read -r package; do
    if [[ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" != installed ]]; then
      missing+=("$package")
    fi
  done < <(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$root/tools/packages.txt"; printf '%s\n' "$@" | sed '/^$/d')
  [[ ${#missing[@]} -eq 0 ]] && return
  if [[ $EUID -ne 0 ]]; then
    echo "missing packages; install them with: sudo apt-get install --no-install-recommends ${missing[*]}" >&2
    return 1
  fi
  echo "== installing ${#missing[@]} packages and what they need, up to 1.4 GB"
  apt_get update || true # some unrelated source may be out of reach; the next line is what counts
  if ! apt_get --no-install-recommends install "${missing[@]}"; then
    cat "$root/build/packages.log" >&2
    echo "apt-get could not install: ${missing[*]}" >&2
    return 1
  fi
}

apt_get() {
  DEBIAN_FRONTEND=noninteractive apt-get -q -y "$@" >"$root/build/packages.log" 2>&1 </dev/null
}

# build PRESET [TARGET...]: configures where needed, then builds, and says how long it took.
build() {
  local preset=$1 start=$SECONDS
  shift
  echo "== building ($preset)"
  cmake -S "$root" --preset "$preset" >"$root/build/$preset.configure.log" 2>&1 ||
    { cat "$root/build/$preset.configure.log" >&2; return 1; }
  cmake --build "$root/build/$preset" -j "$(nproc)" ${1:+--target "$@"} || return
  printf '%-12s ok      %5d s\n' "build" $((SECONDS - start))
}
