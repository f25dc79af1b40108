// The command `ivory bench all`.
#pragma once

#include "tools/cli/common.h"
#include "tools/cli/options.h"

namespace ivory {

// `bench` is the `ivory bench` command.
void add_bench_all_command(Command bench, CommonOptions& common);

}  // namespace ivory
