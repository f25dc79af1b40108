// What a job file says of an option, as the command line takes it.
#pragma once

#include <string>
#include <vector>

#include "tools/batch/job/job.h"
#include "tools/cli/program.h"

namespace ivory {

// The options of a kind of asset, asked of its command once.
const std::vector<OptionFacts>& options_of(const AssetKind& kind);
// nullptr for none of that name.
const OptionFacts* find_option(const AssetKind& kind, const std::string& name);
// "METRES" of "METRES:above 0".
std::string type_of(const OptionFacts& option);

// One option from its entry; nothing for a flag that is false. Throws JobError where the entry's value is not of the
// option's kind; what the value itself must be is for check_options() to say.
std::vector<JobOption> make_option(const AssetKind& kind, const JobEntry& entry);

// Throws JobError for what the command would refuse, at the option's place.
void check_options(const JobAsset& asset);

}  // namespace ivory
