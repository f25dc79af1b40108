#include "tracer/core/sampler.h"

#include <Random123/philox.h>

namespace ivory {

void RandomStream::refill() {
  const r123::Philox4x32::key_type key{{static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32U)}};
  const r123::Philox4x32::ctr_type counter{
      {block_count_++, purpose_, static_cast<std::uint32_t>(index_), static_cast<std::uint32_t>(index_ >> 32U)}};
  const auto block = r123::Philox4x32{}(counter, key);
  block_ = {block[0], block[1], block[2], block[3]};
  used_ = 0;
}

}  // namespace ivory
