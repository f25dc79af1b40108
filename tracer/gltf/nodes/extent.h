// Where a file's nodes put what they show, in double, before anything is placed in floats. Private to the loader.
#pragma once

#include <vector>

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

class Extent {
 public:
  // Of scene.meshes as the file has them.
  Extent(Document& document, Scene& scene) : document_(document), scene_(scene) {}

  // A mesh under a node's transform to the world, metres. Where its vertices lie far from their own origin they are
  // moved there first: see mesh_offset(). Throws Error for what lies farther out than a million km, and for vertices so
  // far out that floats do not hold the mesh; warns of those that they hold badly.
  void add_mesh(std::size_t node, int mesh, const Imath::M44d& world);
  void add_ball(std::size_t node, const V3d& center_m, double radius_m);

  // Vertices of the mesh plus this are where the file has them.
  V3d mesh_offset(int mesh) const;

  // Warns where instances' places, floats of the file, are coarse beside the mesh.
  void check_steps(std::size_t node, int mesh, const std::vector<Imath::M44d>& instances);

  // Where the bulk of it stands, rounded (grid/base/anchor.h): bulk is counted in triangles, so that neither wide
  // ground nor a thing forgotten far away draws it off. Warns of what is too small for its distance from there.
  V3d choose_anchor();

 private:
  struct Piece {
    V3d center_m;
    double half_m = 0;  // of its box's longest side
    double triangles = 0;
    std::size_t node = 0;
  };
  struct MeshBox {
    Imath::Box3d box;  // of its positions, moved
    V3d offset{0, 0, 0};
  };

  const MeshBox& box_of(std::size_t node, int mesh);
  void check_vertices(std::size_t node, const Mesh& mesh, float farthest);
  double middle(std::vector<std::size_t>& order, const std::vector<double>& values) const;

  Document& document_;
  Scene& scene_;
  std::vector<MeshBox> boxes_;  // [mesh]
  std::vector<Piece> pieces_;
};

}  // namespace ivory::gltf
