#include "tools/batch/job/value.h"

#include <fmt/format.h>

namespace ivory {

std::string text_of(const JobPlace& place) {
  return fmt::format("{}:{}:{}", place.file ? *place.file : "", place.line, place.column);
}

const JobEntry* find_entry(const JobTable& table, const std::string& key) {
  for (const JobEntry& entry : table) {
    if (entry.key == key) return &entry;
  }
  return nullptr;
}

JobEntry* find_entry(JobTable& table, const std::string& key) {
  for (JobEntry& entry : table) {
    if (entry.key == key) return &entry;
  }
  return nullptr;
}

std::string kind_of(const JobValue& value) {
  static const char* const names[] = {"a text", "a whole number", "a number", "true or false", "a list", "a table"};
  return names[value.data.index()];
}

const JobTable& table_of(const JobEntry& entry, const std::string& expected) {
  if (const JobTable* table = entry.value.table()) return *table;
  throw JobError(entry.value.place, fmt::format("'{}' is {}", entry.key, kind_of(entry.value)), "write " + expected);
}

std::string text_of(const JobEntry& entry, const std::string& expected) {
  if (const std::string* text = entry.value.text()) return *text;
  throw JobError(entry.value.place, fmt::format("'{}' is {}", entry.key, kind_of(entry.value)), "write " + expected);
}

}  // namespace ivory
