// ivory chart: measures the methods against each other and draws the results, by the Python scripts in tools/chart.
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"

namespace ivory {

namespace {

namespace fs = std::filesystem;

std::string own_path() {
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/exe", error);
  if (error) throw Error("/proc/self/exe", "cannot be read: " + error.message(), "chart needs a mounted /proc");
  return path.string();
}

// The folder that holds tools/chart and scenes: beside the program where it was installed, or where it was built from.
std::string source_folder() {
  const fs::path installed = fs::path(own_path()).parent_path().parent_path() / "share" / "ivory";
  for (const fs::path& folder : {installed, fs::path(IVORY_SOURCE_DIR)}) {
    std::error_code error;
    if (fs::exists(folder / "tools" / "chart" / "chart.py", error)) return folder.string();
  }
  throw Error("tools/chart/chart.py", "is neither under " + installed.string() + " nor under " + IVORY_SOURCE_DIR,
              "keep the sources beside the program");
}

// Runs a command with its output thrown away; is it there, and does it end well?
bool succeeds(const std::vector<std::string>& words) {
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const int nothing = ::open("/dev/null", O_RDWR);
    for (const int stream : {0, 1, 2}) ::dup2(nothing, stream);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  return child > 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// A Python that has what the charts need: $IVORY_PYTHON, the first on the PATH, or the system's.
std::string find_python() {
  const char* chosen = std::getenv("IVORY_PYTHON");
  for (const std::string& python :
       {std::string(chosen != nullptr ? chosen : "python3"), std::string("/usr/bin/python3")}) {
    // Looked for, not loaded: that takes a quarter of a second.
    if (succeeds({python, "-c",
                  "import sys; from importlib.util import find_spec as f; "
                  "sys.exit(sys.version_info < (3, 9) or not (f('matplotlib') and f('jinja2')))"}))
      return python;
  }
  throw Error("ivory chart", "finds no Python 3.9 with matplotlib and jinja2",
              "install Debian's python3-matplotlib and python3-jinja2, or name an interpreter by IVORY_PYTHON");
}

void run_chart(const std::vector<std::string>& arguments, const CommonOptions& common) {
  const fs::path source = source_folder();
  std::vector<std::string> words{find_python(), "-B", (source / "tools" / "chart" / "chart.py").string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  for (const std::string& word : {std::string("--threads"), std::to_string(thread_count(common)),
                                  std::string("--ivory"), own_path(), std::string("--source"), source.string()})
    words.push_back(word);
  if (common.quiet) words.push_back("--quiet");
  if (common.json) words.push_back("--json");
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execvp(argv[0], argv.data());  // comes back only where it fails
  throw Error(words[0], std::strerror(errno), "check IVORY_PYTHON");
}

}  // namespace

void add_chart_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand(
      "chart", "Measure speed against accuracy and draw it: results as JSON lines, charts, one page");
  auto arguments = std::make_shared<std::vector<std::string>>();
  const auto pass = [arguments](const std::string& name) {
    return [arguments, name](const std::string& value) {
      arguments->push_back(name);
      arguments->push_back(value);
    };
  };
  command
      .add_option(
          "suite", [arguments](const std::string& suite) { arguments->insert(arguments->begin(), suite); },
          "quick (minutes), full (under two hours on two cores), or one curve: grid, bases, sh9, fiv, cubemap, lobes,\n"
          "rates, stability (each place where a method fails), economy (beside a sweep of hours, in neither suite)")
      .required()
      .one_of({"quick", "full", "grid", "economy", "bases", "sh9", "fiv", "cubemap", "lobes", "rates", "stability"})
      .type_name("SUITE");
  command
      .add_option("-o,--output", pass("--output"),
                  "Folder for results.jsonl, charts (.svg, .png) and index.html\n(SUITE.html of one curve)")
      .required()
      .type_name("FOLDER");
  command
      .add_option("--only", pass("--only"),
                  "Only points whose name CURVE/SCENE/SERIES/SETTING matches; * is wild; may be repeated")
      .repeated()
      .type_name("PATTERN");
  command
      .add_option("--size", pass("--size"),
                  "Of a single curve: quick or full [quick]; of grid and sh9 rough too, which is no\nmeasurement but a "
                  "try of seconds")
      .one_of({"rough", "quick", "full"})
      .type_name("SIZE");
  command
      .add_option("--fill", pass("--fill"),
                  "Rewrite the tables between <!-- chart: NAME --> and <!-- /chart "
                  "--> of a Markdown file, and copy\nthe charts "
                  "that it shows as charts/NAME.png beside it; may be repeated")
      .repeated()
      .type_name("FILE.md");
  for (const auto& [name, description] : std::array<std::pair<const char*, const char*>, 3>{
           {{"--list", "Print the points, and which are done, instead of measuring them"},
            {"--draw", "Measure nothing, draw what the folder's results.jsonl has"},
            {"--any-build", "Keep results that another build of this version of ivory measured"}}}) {
    command.add_flag(
        name, [arguments, flag = std::string(name)] { arguments->push_back(flag); }, description);
  }
  command.footer(
      "Each point is one or a few ivory commands; results.jsonl has them with seed, machine, time, peak memory and\n"
      "result. What it has is not measured again: an interrupted suite goes on. Sample data is looked for under\n"
      "$IVORY_DATA. Needs python3-matplotlib and python3-jinja2.\n"
      "\nExamples:\n"
      "  ivory chart quick -o out/charts\n"
      "  ivory chart grid -o out/charts --size full --only '*cornell*'");
  set_action(command, common, Output::none, [arguments, &common] { run_chart(*arguments, common); });
}

}  // namespace ivory
