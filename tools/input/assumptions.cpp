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

void keep_assumptions(Metadata& metadata, const std::vector<std::string>& warnings) {
  std::string lines = find_text(metadata, "assumptions").value_or("");
  for (const std::string& warning : warnings) {
    const std::string line = without_folders(warning);
    if (("\n" + lines + "\n").find("\n" + line + "\n") == std::string::npos)
      lines += (lines.empty() ? "" : "\n") + line;
  }
  if (!lines.empty()) metadata["assumptions"] = lines;
}

}  // namespace ivory
