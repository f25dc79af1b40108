// An irradiance cache (Ward, Rubinstein & Clear, "A Ray Tracing Solution for Diffuse Interreflection", 1988): records
// of E at surfaces, and E between them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tracer/render/gather/record.h"

namespace ivory {

class IrradianceCache {
 public:
  // For places within that sphere (world, m); others are found too, more slowly.
  IrradianceCache(const V3f& center, float radius_m);

  // Adds a record. A record that reaches over it may not be trusted much farther than to where the new one is, and the
  // other way about: what one of them saw the other may have missed (Krivanek et al., "Making Radiance and Irradiance
  // Caching Practical", 2006). No radius becomes smaller than least_radius_m.
  void add(IrradianceRecord record, float least_radius_m);

  // Sum of the weights of the records at a surface: how well they cover it.
  float coverage(const Surface& surface) const;
  // E in lux between the records around a surface, none where they have less than least_coverage.
  static constexpr float least_coverage = 0.05F;
  std::optional<Rgb> irradiance(const Surface& surface) const;

  std::size_t size() const { return records_.size(); }
  const std::vector<IrradianceRecord>& records() const { return records_; }

 private:
  struct Entry {
    V3f p;
    float radius2 = 0;  // when it was added: the record's own may be smaller since
    std::uint32_t record = 0;
  };
  // An octree. A node's own entries reach over it and are about as large as it; children are 0 where there is none.
  struct Node {
    std::array<std::uint32_t, 8> child{};
    std::vector<Entry> entries;
  };
  template <typename Visit>
  void visit(const V3f& p, const Visit& see) const;
  void insert(std::uint32_t node, const V3f& center, float half, const Entry& entry, float radius_m);

  V3f center_;
  float half_;
  std::vector<Node> nodes_;
  std::vector<IrradianceRecord> records_;
};

}  // namespace ivory
