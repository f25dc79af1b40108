// How groups of lights are dimmed and coloured on the command line.
#pragma once

#include <string>

#include "grid/field/mix.h"
#include "tools/cli/options.h"

namespace ivory {

// What the options are called, and where the help lists them.
struct GroupFactorOptions {
  std::string scale = "--scale";
  std::string tint = "--tint";
  std::string heading = {};  // of the help page; empty: none of their own
};

// Adds both, which multiply into `factors`.
void add_group_factor_options(Command command, GroupFactors& factors, const GroupFactorOptions& names = {});

// A factor as text: "hall=0.5,0.45,0.4".
std::string text_of(const std::string& group, const Rgb& factor);

}  // namespace ivory
