#include "tracer/bake/field/contract/state.h"

namespace ivory {

ContractState::ContractState(const LitScene& lit_scene, const ContractParams& contract_params)
    : lit(lit_scene),
      params(contract_params),
      cover(covering_frame(*lit.scene, params.bake)),
      domain(*lit.scene, {.frame = cover,
                          .kind = params.domain,
                          .dynamic_regions = params.bake.dynamic_regions,
                          .given = params.points,
                          .seed = params.bake.seed}) {
  truth.max_bounces = params.bake.max_bounces;
  truth.indirect_only = !params.bake.include_direct;
  truth.seed = params.bake.seed;
}

void SumsAtHand::add(GridAccumulator more) {
  std::vector<GridAccumulator> two;
  two.push_back(std::move(*sums));
  two.push_back(std::move(more));
  sums = merge(std::move(two), {"the photons at hand", "those added to them"});
}

}  // namespace ivory
