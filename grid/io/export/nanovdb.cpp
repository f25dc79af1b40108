#include "grid/io/export/nanovdb.h"

#include <array>
#include <vector>

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/openvdb.h>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/vdb/layout.h"

namespace ivory {

void write_nanovdb(const std::string& path, const ProbeVolume& volume, bool force) {
  constexpr std::array<const char*, 6> names{"E_px", "E_mx", "E_py", "E_my", "E_pz", "E_mz"};
  openvdb::initialize();
  PendingFile pending(path, force);
  const auto matrix = transform_matrix({volume.frame, volume.anchor_m});
  std::vector<nanovdb::GridHandle<>> handles;
  for (std::size_t side = 0; side < 6; ++side) {
    const auto grid = openvdb::Vec3SGrid::create(openvdb::Vec3s(0.0F));
    grid->setName(names[side]);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(openvdb::Mat4d(matrix.data())));
    auto accessor = grid->getAccessor();
    for (std::size_t i = 0; i < volume.sides.size(); ++i) {
      const V3i at = volume.frame.vertex_coordinates(i);
      const Rgb& e = volume.sides[i][side];
      accessor.setValue(openvdb::Coord(at.x, at.y, at.z), openvdb::Vec3s(e.x, e.y, e.z));
    }
    handles.push_back(nanovdb::openToNanoVDB(*grid));
  }
  try {
    nanovdb::io::writeGrids(pending.temporary(), handles, nanovdb::io::Codec::NONE);
  } catch (const std::exception& error) {
    throw Error(path, "cannot be written (" + std::string(error.what()) + ")", "check its folder and its disk");
  }
  pending.commit();
}

}  // namespace ivory
