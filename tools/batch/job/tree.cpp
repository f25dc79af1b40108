#include "tools/batch/job/tree.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "tools/cli/usage_error.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

// Levenshtein's distance: letters to put in, take out or exchange.
std::size_t letters_apart(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t corner = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, corner + (a[i - 1] == b[j - 1] ? 0 : 1)});
      corner = above;
    }
  }
  return row[b.size()];
}

void merge_under(JobTable& table, const JobTable& more) {
  for (const JobEntry& entry : more) {
    if (find_entry(table, entry.key) == nullptr) table.push_back(entry);
  }
}

class Reader {
 public:
  Reader(const std::vector<std::string>& kinds, JobTree& tree) : kinds_(kinds), tree_(tree) {}

  void read(const std::string& path, const JobPlace* from) {
    const std::string name = fs::path(path).lexically_normal().string();
    if (std::find(open_.begin(), open_.end(), name) != open_.end())
      throw JobError(*from, fmt::format("'{}' includes itself by way of {}", name, fmt::join(open_, ", ")),
                     "leave out one of these includes");
    if (std::find(tree_.files.begin(), tree_.files.end(), name) != tree_.files.end()) return;
    std::error_code error;
    if (from != nullptr && !fs::is_regular_file(name, error))
      throw JobError(*from, fmt::format("there is no file '{}' to include", name),
                     "paths are relative to the file that includes");
    const JobTable table = read_toml(name);
    open_.push_back(name);
    tree_.files.push_back(name);
    if (const JobEntry* include = find_entry(table, "include")) read_includes(*include, name);
    // After what it includes, whose words count less.
    for (const JobEntry& entry : table) {
      if (entry.key != "include") add(entry);
    }
    open_.pop_back();
  }

 private:
  void read_includes(const JobEntry& entry, const std::string& from) {
    const char* const expected = "include = [\"common.toml\"]";
    JobArray one{entry.value};
    const JobArray* list = entry.value.array();
    if (list == nullptr) list = &one;
    for (const JobValue& value : *list) {
      const std::string file = text_of(JobEntry{"include", entry.place, value}, expected);
      read((fs::path(from).parent_path() / file).string(), &value.place);
    }
  }

  void add(const JobEntry& entry) {
    if (entry.key == "variables") {
      for (const JobEntry& variable : table_of(entry, "[variables] with NAME = VALUE"))
        tree_.variables.insert_or_assign(variable.key, variable.value);
    } else if (entry.key == "job") {
      JobTable table = table_of(entry, "[job]");
      merge_under(table, tree_.job);
      tree_.job = std::move(table);
    } else if (entry.key == "default") {
      for (const JobEntry& kind : table_of(entry, "[default.KIND]")) {
        check_kind(kind, "default.");
        JobTable table = table_of(kind, fmt::format("[default.{}] with options", kind.key));
        JobTable& known = tree_.defaults[kind.key];
        merge_under(table, known);
        known = std::move(table);
      }
    } else {
      check_kind(entry, "");
      const JobTable& named = table_of(entry, fmt::format("[{}.NAME] with options", entry.key));
      for (const JobEntry& section : named) {
        const std::string expected =
            fmt::format("[{0}.NAME] with options below; '{1}' is no name of a section of {0}", entry.key, section.key);
        add_section({entry.key, section.key, section.place, table_of(section, expected)});
      }
    }
  }

  void check_kind(const JobEntry& entry, const std::string& before) const {
    if (std::find(kinds_.begin(), kinds_.end(), entry.key) != kinds_.end()) return;
    throw JobError(entry.place,
                   fmt::format("'{}{}' is no kind of section{}", before, entry.key, like(entry.key, kinds_)),
                   fmt::format("there are {}, job, variables, default and include", fmt::join(kinds_, ", ")));
  }

  void add_section(JobSection section) {
    for (const JobSection& known : tree_.sections) {
      if (known.kind != section.kind || known.name != section.name) continue;
      throw JobError(section.place,
                     fmt::format("[{}.{}] is already at {}", section.kind, section.name, text_of(known.place)),
                     "give each a name of its own");
    }
    tree_.sections.push_back(std::move(section));
  }

  const std::vector<std::string>& kinds_;
  JobTree& tree_;
  std::vector<std::string> open_;
};

// What stands for a name, its own variables replaced; `ring` holds the names on the way.
JobValue replace(const JobValue& value, const JobScope& scope, std::vector<std::string>& ring);

JobValue value_of(const std::string& name, const JobPlace& place, const JobScope& scope,
                  std::vector<std::string>& ring) {
  if (std::find(ring.begin(), ring.end(), name) != ring.end())
    throw JobError(place, fmt::format("variable '{}' stands for itself by way of {}", name, fmt::join(ring, ", ")),
                   "give one of them a value without the others");
  std::vector<std::string> names;
  for (auto variables = scope.rbegin(); variables != scope.rend(); ++variables) {
    const auto found = (*variables)->find(name);
    if (found != (*variables)->end()) {
      ring.push_back(name);
      JobValue value = replace(found->second, scope, ring);
      ring.pop_back();
      value.place = place;
      return value;
    }
    for (const auto& [known, unused] : **variables) names.push_back(known);
  }
  throw JobError(
      place, fmt::format("there is no variable '{}'{}", name, like(name, names)),
      names.empty() ? "[variables] gives names values" : fmt::format("known are {}", fmt::join(names, ", ")));
}

std::string as_text(const JobValue& value, const std::string& name, const JobPlace& place) {
  if (const std::string* text = value.text()) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&value.data)) return fmt::format("{}", *number);
  if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
  throw JobError(place, fmt::format("variable '{}' is {} and cannot stand within a text", name, kind_of(value)),
                 "let it stand alone, as \"${" + name + "}\"");
}

JobValue replace_text(const JobValue& value, const std::string& text, const JobScope& scope,
                      std::vector<std::string>& ring) {
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find("${", at);
    if (open == std::string::npos) break;
    if (open > 0 && text[open - 1] == '$') {
      out += text.substr(at, open - 1 - at) + "${";
      at = open + 2;
      continue;
    }
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos)
      throw JobError(value.place, "a ${ has no }", "write ${NAME}, or $${ for the letters themselves");
    const std::string name = text.substr(open + 2, close - open - 2);
    JobValue meant = value_of(name, value.place, scope, ring);
    if (open == 0 && close + 1 == text.size()) return meant;
    out += text.substr(at, open - at) + as_text(meant, name, value.place);
    at = close + 1;
  }
  out += text.substr(std::min(at, text.size()));
  return {out, value.place};
}

JobValue replace(const JobValue& value, const JobScope& scope, std::vector<std::string>& ring) {
  if (const std::string* text = value.text()) return replace_text(value, *text, scope, ring);
  JobValue out = value;
  if (auto* array = std::get_if<JobArray>(&out.data)) {
    for (JobValue& element : *array) element = replace(element, scope, ring);
  } else if (auto* table = std::get_if<JobTable>(&out.data)) {
    for (JobEntry& entry : *table) entry.value = replace(entry.value, scope, ring);
  }
  return out;
}

}  // namespace

JobTree read_job_tree(const std::string& path, const std::vector<std::string>& set,
                      const std::vector<std::string>& kinds) {
  JobTree tree;
  Reader(kinds, tree).read(path, nullptr);
  for (const std::string& text : set) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) throw UsageError("--set: '" + text + "' is not NAME=VALUE");
    const auto known = tree.variables.find(text.substr(0, equals));
    if (known == tree.variables.end())
      throw UsageError(fmt::format("--set: {} has no variable '{}' in [variables]", path, text.substr(0, equals)));
    known->second.data = text.substr(equals + 1);
  }
  return tree;
}

JobValue substituted(const JobValue& value, const JobScope& scope) {
  std::vector<std::string> ring;
  return replace(value, scope, ring);
}

std::string like(const std::string& name, const std::vector<std::string>& names) {
  std::string best;
  std::size_t least = 1 + name.size() / 3;
  for (const std::string& known : names) {
    const std::size_t apart = letters_apart(name, known);
    if (apart > least || (apart == least && !best.empty())) continue;
    least = apart;
    best = known;
  }
  return best.empty() ? "" : fmt::format(" (did you mean '{}'?)", best);
}

}  // namespace ivory
