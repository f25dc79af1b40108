// Writes small valid files of every kind into a folder: where the fuzzers begin.
//
// usage: fuzz_seeds FOLDER
#include <array>
#include <cstdio>
#include <exception>

#include "grid/io/file.h"
#include "grid/io/image_codec.h"
#include "grid/io/sh9.h"
#include "grid/io/sphere_set.h"
#include "grid/io/vdb/vdb.h"
#include "tests/fuzz/samples.h"

namespace {

using namespace ivory;

void write_images(const std::string& folder) {
  std::array<float, std::size_t(8 * 4 * 3)> pixels{};
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = float(i % 7) / 7;
  // No name of the time of day, as the codec writes none.
  for (const char* extension : {"exr", "hdr", "png", "jpg", "tif", "bmp", "tga", "webp", "gif", "dpx", "ppm", "sgi",
                                "jp2", "dds", "psd", "fits", "zfile", "cin", "ico"}) {
    const std::string path = folder + "/image." + extension;
    if (!image_codec().can_write(path)) continue;
    const bool linear = std::string(extension) == "exr" || std::string(extension) == "hdr";
    std::string cause;
    const auto bytes = image_codec().encode(path, {8, 4, PixelType::float32, pixels.data(), linear, {}}, cause);
    if (!bytes.empty()) write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, true);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const std::string folder = argv[1];
    fuzz::write_exr_samples(folder);
    write_images(folder);
    for (const Basis basis : values_of<Basis>())
      write_vdb(folder + "/" + std::string(name_of(basis)) + ".vdb", fuzz::sample_grid(basis), true);
    write_vdb(folder + "/levels.vdb", fuzz::sample_grid_of_levels(), true);
    write_vdb(folder + "/groups.vdb", fuzz::sample_grid_of_groups(), true);
    Sh9Asset sh9;
    sh9.sh.coefficients[0] = V3d(1, 2, 3);
    sh9.sh.coefficients[2] = V3d(0.5, 0.25, 0.125);
    write_sh9(folder + "/sh9.json", sh9, true);
    SphereSet spheres;
    spheres.spheres = {{V3f(0, 1, 2), 0.5F}, {V3f(1, 1, 2), 0.25F}};
    write_spheres(folder + "/spheres.json", spheres, true);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}
