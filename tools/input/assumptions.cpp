#include "tools/input/assumptions.h"

namespace ivory {

namespace {

// "folder/room.glb: has no scene" without the folder.
std::string without_folders(const std::string& warning) {
  const std::size_t name_end = warning.find(": ");
  if (name_end == std::string::npos) return warning;
  const std::size_t slash = warning.rfind('/', name_end);
  return slash == std::string::npos ? warning : warning.substr(slash + 1);
}

}  // namespace

void print_warnings(const CommonOptions& common, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) print_note(common, "warning: " + warning);
}

void keep_assumptions(Metadata& metadata, const std::vector<std::string>& warnings) {
  std::string lines = find_text(metadata, "assumptions").value_or("");
  for (const std::string& warning : warnings) lines += (lines.empty() ? "" : "\n") + without_folders(warning);
  if (!lines.empty()) metadata["assumptions"] = lines;
}

}  // namespace ivory
