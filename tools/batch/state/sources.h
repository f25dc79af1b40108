// The files that a job reads: their hashes, and what scenes hold.
#pragma once

#include <map>
#include <string>

#include "tools/batch/state/record.h"

namespace ivory {

// Files are read each time the program runs, never trusted by their time: an edit within a clock's tick is found too.
// Scenes are loaded only where a byte of theirs has changed since `known` was recorded.
class Sources {
 public:
  explicit Sources(std::map<std::string, SceneFacts> known) : known_(std::move(known)) {}

  // Of a file's bytes. Throws Error where it cannot be read.
  const std::string& hash(const std::string& path);
  // Forgets it: the file is to be written.
  void forget(const std::string& path);
  // Throws Error as load_gltf() does.
  const SceneFacts& scene(const std::string& path, const LoadParams& params);

  // What scene() has answered, for the next run's record.
  std::map<std::string, SceneFacts> facts() const { return facts_; }

 private:
  bool is_unchanged(const SceneFacts& facts);

  std::map<std::string, SceneFacts> known_;
  std::map<std::string, SceneFacts> facts_;
  std::map<std::string, std::string> hashes_;
};

}  // namespace ivory
