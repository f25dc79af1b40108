#include "tools/view/world/path.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/csv.h"
#include "tools/cli/numbers.h"

namespace ivory {

namespace {

constexpr std::size_t max_keys = 100'000;

UsageError bad_path(const std::string& text, const std::string& cause) {
  return UsageError(
      fmt::format("--path: '{}' {}; it is circle:RADIUS[,SECONDS], line:X,Y,Z[,SECONDS], turn:SECONDS or keys:FILE.csv",
                  text, cause));
}

// `least` numbers, or one more that is the period.
std::vector<float> numbers(const std::string& text, const std::string& values, std::size_t least) {
  const auto commas = std::size_t(std::count(values.begin(), values.end(), ','));
  const std::size_t count = commas == least ? least + 1 : least;
  const std::vector<double> v =
      parse_numbers("--path", values, count, "circle:RADIUS[,SECONDS] or line:X,Y,Z[,SECONDS]");
  if (count > least && !(v.back() > 0)) throw bad_path(text, "has a period that is not positive");
  return {v.begin(), v.end()};
}

std::vector<Keyframe> read_keys(const std::string& file) {
  const std::string remedy =
      "write lines t,x,y,z, or with rx,ry,rz and a scale behind: seconds, metres, degrees, such as 0.5,1,0,0";
  std::vector<Keyframe> keys;
  for (const CsvLine& line : read_csv_lines(file, remedy)) {
    if (line.text.empty() || line.text.front() == '#' || line.text.starts_with("t,x,y,z")) continue;
    const auto cells = csv_cells(line.text);
    if (cells.size() != 4 && cells.size() != 7 && cells.size() != 8)
      throw Error(file, fmt::format("line {} has {} cells", line.number, cells.size()), remedy);
    const auto number = [&](std::size_t i, const char* column) {
      return csv_number(file, line, cells[i], column, remedy);
    };
    Keyframe key{number(0, "t"), {V3f(V3d(number(1, "x"), number(2, "y"), number(3, "z"))), V3f(0, 0, 0), 1}};
    if (cells.size() > 4) key.at.turn_deg = V3f(V3d(number(4, "rx"), number(5, "ry"), number(6, "rz")));
    if (cells.size() > 7) key.at.scale = float(number(7, "scale"));
    if (!(key.at.scale > 0))
      throw Error(file, fmt::format("line {} has a scale that is not above 0", line.number), remedy);
    keys.push_back(key);
    if (keys.back().time_s < 0 || (keys.size() > 1 && keys.back().time_s <= keys[keys.size() - 2].time_s)) {
      throw Error(file, fmt::format("the time of line {} is not later than the one before", line.number),
                  "put keyframes in order, from 0 s");
    }
    if (keys.size() > max_keys) throw Error(file, "has more than 100000 keyframes", "leave out some");
  }
  if (keys.empty() || keys.back().time_s == 0) throw Error(file, "holds no keyframe after 0 s", remedy);
  return keys;
}

PathPoint between_keys(const std::vector<Keyframe>& keys, double time_s) {
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), time_s, [](double t, const Keyframe& key) { return t < key.time_s; });
  if (after == keys.begin()) return keys.front().at;
  if (after == keys.end()) return keys.back().at;
  const Keyframe& before = after[-1];
  const auto share = float((time_s - before.time_s) / (after->time_s - before.time_s));
  const auto mix = [&](const auto& a, const auto& b) { return a * (1 - share) + b * share; };
  return {mix(before.at.offset_m, after->at.offset_m), mix(before.at.turn_deg, after->at.turn_deg),
          mix(before.at.scale, after->at.scale)};
}

}  // namespace

ObjectPath parse_path(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw bad_path(text, "names no kind of path");
  const std::string kind = text.substr(0, colon);
  const std::string values = text.substr(colon + 1);
  ObjectPath path;
  if (kind == "circle") {
    const std::vector<float> v = numbers(text, values, 1);
    path.kind = ObjectPath::Kind::circle;
    path.radius_m = v[0];
    if (v.size() > 1) path.period_s = double(v[1]);
  } else if (kind == "line") {
    const std::vector<float> v = numbers(text, values, 3);
    path.kind = ObjectPath::Kind::line;
    path.there_m = V3f(v[0], v[1], v[2]);
    if (v.size() > 3) path.period_s = double(v[3]);
  } else if (kind == "turn") {
    path.kind = ObjectPath::Kind::turn;
    path.period_s = parse_numbers("--path", values, 1, "turn:SECONDS")[0];
    if (!(path.period_s > 0)) throw bad_path(text, "has a period that is not positive");
  } else if (kind == "keys") {
    path.kind = ObjectPath::Kind::keys;
    path.keys = read_keys(values);
    path.period_s = path.keys.back().time_s;
  } else {
    throw bad_path(text, "names no kind of path");
  }
  return path;
}

PathPoint at(const ObjectPath& path, double time_s) {
  const double within = std::fmod(time_s, path.period_s);
  const double turn = 2 * double(pi) * within / path.period_s;
  switch (path.kind) {
    case ObjectPath::Kind::none:
      break;
    case ObjectPath::Kind::circle:
      // Starts at the object's own place, so that what stands free on the command line does so at first.
      return {V3f(float(std::cos(turn)) - 1, 0, float(-std::sin(turn))) * path.radius_m, V3f(0, 0, 0), 1};
    case ObjectPath::Kind::line:
      return {path.there_m * float(0.5 - 0.5 * std::cos(turn)), V3f(0, 0, 0), 1};
    case ObjectPath::Kind::turn:
      return {V3f(0, 0, 0), V3f(0, float(360 * within / path.period_s), 0), 1};
    case ObjectPath::Kind::keys:
      return between_keys(path.keys, within);
  }
  return {};
}

}  // namespace ivory
