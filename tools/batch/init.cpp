#include "tools/batch/init.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/io/file.h"
#include "tools/batch/job/each.h"
#include "tools/batch/state/sources.h"
#include "tools/input/scene.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

// A text in TOML; what names in glTF files may hold is escaped.
std::string toml_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// In a comment.
std::string said(const std::string& text) { return in_one_line(text); }

bool is_roomlike(const std::string& name) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  constexpr std::array words{"room",   "hall",   "corridor", "kitchen", "bath",
                             "cellar", "office", "chamber",  "nave",    "attic"};
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return lower.find(word) != std::string::npos; });
}

// Pieces of furniture are called after rooms too ("hall_lamp"): a room is higher than a table and wider than a door.
std::vector<NodeBox> rooms_of(const std::vector<NodeBox>& nodes) {
  std::vector<NodeBox> rooms;
  std::set<std::string> names;
  for (const NodeBox& node : nodes) {
    const V3d size = node.bounds_m.size();
    if (is_roomlike(node.name) && size.x > 1.5 && size.y > 1.5 && size.z > 1.5 &&
        names.insert(plain_name(node.name)).second)
      rooms.push_back(node);
  }
  return rooms;
}

// "Room*" for Room_1, Room_2 and all others that begin so and are rooms; empty where no pattern finds just these.
std::string pattern_of(const std::vector<NodeBox>& rooms, const std::vector<NodeBox>& nodes) {
  std::string prefix = rooms.front().name;
  for (const NodeBox& room : rooms) {
    std::size_t same = 0;
    while (same < prefix.size() && same < room.name.size() && prefix[same] == room.name[same]) ++same;
    prefix.resize(same);
  }
  if (prefix.size() < 3 || is_pattern(prefix)) return {};
  const auto found =
      std::count_if(nodes.begin(), nodes.end(), [&](const NodeBox& node) { return node.name.starts_with(prefix); });
  return std::size_t(found) == rooms.size() ? prefix + "*" : std::string();
}

std::vector<std::string> environments_beside(const fs::path& scene) {
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = scene.parent_path().empty() ? fs::path(".") : scene.parent_path();
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string extension = lower_extension(entry.path().string());
    if (entry.is_regular_file(error) && extension == ".hdr") names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class FirstJob {
 public:
  FirstJob(const std::string& scene, std::string scene_path)
      : file_(scene), path_(std::move(scene_path)), loaded_(load_gltf(scene)) {
    Sources sources({});
    nodes_ = sources.scene(scene, {}).nodes;
    name_ = plain_name(fs::path(scene).stem().string());
    std::replace(name_.begin(), name_.end(), '.', '_');
  }

  std::string text() {
    head();
    inputs();
    grids();
    cubemaps();
    environments();
    occluders();
    renders();
    return std::move(text_);
  }

 private:
  template <typename... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    text_ += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }

  void head() {
    const Scene& scene = loaded_.scene;
    const V3f size = bounds(scene).isEmpty() ? V3f(0, 0, 0) : bounds(scene).size();
    std::size_t triangles = 0;
    for (const Instance& instance : scene.instances)
      triangles += scene.meshes[std::size_t(instance.mesh)].triangles.size();
    line("# What to bake of {}: {} triangles, {:.3g} x {:.3g} x {:.3g} m, {} punctual lights, {} cameras.", said(path_),
         triangles, size.x, size.y, size.z, scene.lights.size(), scene.cameras.size());
    line("# ivory batch bakes it; --dry-run says what that takes. docs/batch.md says what else may stand here.");
    line("\n[job]\noutput = \"baked\"  # folder of the assets, beside this file");
    line("\n[variables]\nerror = \"5%\"  # of irradiance, RMS over what is lit; 2% costs about ten times as much");
  }

  void inputs() {
    line("\n[scene.{}]\nfile = {}", name_, toml_text(path_));
    line("# scale = 0.01        # where the file is in centimetres");
    line("# without = [\"Chair*\"]  # nodes that will move: their light is not baked in");
    const std::vector<std::string> found = environments_beside(file_);
    if (!found.empty()) {
      const fs::path folder = fs::path(path_).parent_path();
      environment_ = plain_name(fs::path(found.front()).stem().string());
      std::replace(environment_.begin(), environment_.end(), '.', '_');
      line("\n[environment.{}]\nfile = {}", environment_, toml_text((folder / found.front()).string()));
      if (found.size() > 1)
        line("# also there: {}", said(fmt::format("{}", fmt::join(found.begin() + 1, found.end(), ", "))));
    } else {
      line("\n# [environment.sky]    # what lights the scene from outside\n# file = \"sky.hdr\"");
    }
  }

  void environment_line() {
    if (!environment_.empty()) line("env = {}", toml_text(environment_));
  }

  void grids() {
    const Scene& scene = loaded_.scene;
    line("\n# Indirect light.\n[default.grid]\ntarget_error = \"${{error}}\"");
    std::set<std::string> groups;
    for (const SceneNode& node : scene.nodes) {
      if (!node.light_group.empty()) groups.insert(node.light_group);
    }
    if (!groups.empty())
      line("groups = \"extras\"  # of lamps: {}; 'ivory mix' dims each",
           said(fmt::format("{}", fmt::join(groups, ", "))));
    const std::vector<NodeBox> rooms = rooms_of(nodes_);
    const std::string pattern = rooms.size() > 1 ? pattern_of(rooms, nodes_) : "";
    if (rooms.size() > 1 && !pattern.empty()) {
      line("\n[grid.rooms]  # one for each of {} rooms", rooms.size());
      line("each = {{ scene = {}, nodes = {}, margin = \"5 cm\" }}", toml_text(name_), toml_text(pattern));
      line("scene = {}\nbounds = \"${{bounds}}\"", toml_text(name_));
      environment_line();
      grid_ = "rooms." + plain_name(rooms.front().name);
      return;
    }
    line("\n[grid.{}]\nscene = {}", name_, toml_text(name_));
    environment_line();
    if (rooms.size() > 1) {
      line("# Rooms of the scene, for a grid of each by bounds = \"X0,Y0,Z0:X1,Y1,Z1\":");
      for (const NodeBox& room : rooms) {
        const V3d& a = room.bounds_m.min;
        const V3d& b = room.bounds_m.max;
        line("#   {}: {:.4g},{:.4g},{:.4g}:{:.4g},{:.4g},{:.4g}", said(room.name), a.x, a.y, a.z, b.x, b.y, b.z);
      }
    }
    grid_ = name_;
  }

  void cubemaps() {
    if (bounds(loaded_.scene).isEmpty()) return;
    const Scene& scene = loaded_.scene;
    const V3f middle = bounds(scene).center();
    const V3d at = scene.anchor_m + V3d(middle.x, middle.y, middle.z);
    line("\n# What moving objects near a place are lit by.\n# [cubemap.{}]\n# scene = {}", name_, toml_text(name_));
    if (!environment_.empty()) line("# env = {}", toml_text(environment_));
    line("# at = [{:.4g}, {:.4g}, {:.4g}]  # the middle of the scene: choose a place in the open\n# grid = {}", at.x,
         at.y, at.z, toml_text(grid_));
  }

  void environments() {
    if (environment_.empty()) return;
    line("\n# The environment's own light, without shadows.");
    line("[difmap.{0}]\nenvironment = \"{0}\"\n\n[sh9.{0}]\nenvironment = \"{0}\"", environment_);
  }

  void occluders() {
    std::map<std::string, std::string> tables;
    for (const SceneNode& node : loaded_.scene.nodes) {
      if (!node.fiv_table.empty()) tables.emplace(fs::path(node.fiv_table).filename().string(), node.name);
    }
    if (tables.empty()) return;
    line(
        "\n# Nodes that hide light of the environment (extras.ivory_occluder); 'mesh' is the file of each node's "
        "model.");
    for (const auto& [table, node] : tables) {
      line("# [fiv.{}]  # node {}\n# mesh = \"....glb\"\n# env = {}", plain_name(fs::path(table).stem().string()),
           toml_text(said(node)), toml_text(environment_.empty() ? "sky" : environment_));
    }
  }

  void renders() {
    const auto picture = [&](const std::string& name, const std::string& camera) {
      line("\n[render.{}]\nscene = {}", name, toml_text(name_));
      if (!camera.empty()) line("camera = {}", toml_text(camera));
      environment_line();
      line("method = \"gather\"\ngrid = {}\nsamples = 16\ngather = 4", toml_text(grid_));
    };
    const std::vector<Camera>& cameras = loaded_.scene.cameras;
    if (cameras.empty() || cameras.front().name.empty()) return picture(name_, "");
    constexpr std::size_t most = 3;
    std::set<std::string> names;
    for (const Camera& camera : cameras) {
      std::string name = plain_name(camera.name);
      std::replace(name.begin(), name.end(), '.', '_');
      if (names.size() < most && !camera.name.empty() && names.insert(name).second) picture(name, camera.name);
    }
    if (cameras.size() > names.size()) line("# There are {} more cameras.", cameras.size() - names.size());
  }

  std::string file_;
  std::string path_;
  LoadedScene loaded_;
  std::vector<NodeBox> nodes_;
  std::string name_;
  std::string environment_;
  std::string grid_;  // that pictures read
  std::string text_;
};

}  // namespace

std::string first_job_text(const std::string& scene, const std::string& scene_path) {
  return FirstJob(scene, scene_path).text();
}

void write_first_job(const std::string& scene, const std::string& job, const CommonOptions& common) {
  check_output(job, ".toml", common);
  const fs::path folder = fs::absolute(job).lexically_normal().parent_path();
  const std::string path = fs::absolute(scene).lexically_normal().lexically_relative(folder).string();
  write_file(job, first_job_text(scene, path), common.force);
  print_result(common, {{"file", job}, {"scene", scene}},
               fmt::format("{}: a first job for {}; 'ivory batch {} --dry-run' says what it bakes\n", job, scene, job));
}

}  // namespace ivory
