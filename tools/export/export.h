// What ivory export was asked for.
#pragma once

#include <optional>
#include <string>

#include "grid/export/target.h"

namespace ivory {

struct ExportOptions {
  std::string asset;
  ExportTarget target = ExportTarget::three_js;
  std::string output;
  std::string scene;  // that distant light is put into
};

}  // namespace ivory
