// What a job file says, as plain values that know where they stand.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "grid/base/error.h"

namespace ivory {

// A place in a job file: lines and columns from 1, columns in bytes.
struct JobPlace {
  std::shared_ptr<const std::string> file;
  int line = 1;
  int column = 1;
};
// "level.toml:12:5"
std::string text_of(const JobPlace& place);

// A mistake in a job file: "<file>:<line>:<column>: <cause>; <what was expected>".
class JobError : public Error {
 public:
  JobError(const JobPlace& place, const std::string& cause, const std::string& expected)
      : Error(text_of(place), cause, expected) {}
};

struct JobValue;
struct JobEntry;
using JobArray = std::vector<JobValue>;
using JobTable = std::vector<JobEntry>;  // in the file's order, each key once

struct JobValue {
  std::variant<std::string, std::int64_t, double, bool, JobArray, JobTable> data;
  JobPlace place;

  const std::string* text() const { return std::get_if<std::string>(&data); }
  const JobArray* array() const { return std::get_if<JobArray>(&data); }
  const JobTable* table() const { return std::get_if<JobTable>(&data); }
};

struct JobEntry {
  std::string key;
  JobPlace place;  // of the key
  JobValue value;
};

// The entry of that key, or nullptr.
const JobEntry* find_entry(const JobTable& table, const std::string& key);
JobEntry* find_entry(JobTable& table, const std::string& key);

// "a text", "a number", "a table": for messages.
std::string kind_of(const JobValue& value);

// For what is expected to be a table or a text. Throw JobError: "<key> is a number; write <expected>".
const JobTable& table_of(const JobEntry& entry, const std::string& expected);
std::string text_of(const JobEntry& entry, const std::string& expected);

// A file of TOML. Throws JobError where it is none, and Error where it cannot be read.
JobTable read_toml(const std::string& path);

}  // namespace ivory
