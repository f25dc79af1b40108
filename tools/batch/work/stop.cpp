#include "tools/batch/work/stop.h"

#include <algorithm>

namespace ivory {

BatchStop::BatchStop(const std::string& last_words) { interrupt_.set_last_words(last_words); }

void BatchStop::set(int asset, Stoppable state) {
  const std::scoped_lock lock(mutex_);
  states_[asset] = state;
  interrupt_.be_patient(is_any(Stoppable::saving));
}

bool BatchStop::any(Stoppable state) const {
  const std::scoped_lock lock(mutex_);
  return is_any(state);
}

bool BatchStop::is_any(Stoppable state) const {
  return std::any_of(states_.begin(), states_.end(), [&](const auto& asset) { return asset.second == state; });
}

}  // namespace ivory
