// Bakes that are stopped and gone on from: the same sums, however often and wherever that was; and whose checkpoint it
// is.
#include "tracer/bake/checkpoint.h"

#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/io/vdb/vdb.h"
#include "tests/support/folder_test.h"
#include "tests/support/full_disk.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/deposit/photon_sums.h"
#include "tracer/bake/field/grid_checkpoint.h"
#include "tracer/bake/field/vertex_visibility.h"

namespace ivory {
namespace {

// A closed room with two lamps.
Scene room() {
  Scene scene;
  scene.name = "room";
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), add_lambert(scene, Rgb(0.7F, 0.6F, 0.5F))));
  scene.nodes = {{"Strong", no_index, "", ""}, {"Weak", no_index, "", ""}};
  scene.lights = {PointLight{V3f(-0.5F, 0.5F, 0.5F), Rgb(5, 4, 3)},
                  PointLight{V3f(0.6F, -0.5F, 0.1F), Rgb(0.01F, 0.02F, 0.03F)}};
  scene.light_nodes = {0, 1};
  return scene;
}

GridBakeParams small_bake() {
  GridBakeParams params;
  params.resolution = V3i(4, 5, 6);
  params.photons = 60'000;
  return params;
}

void expect_same(const GridAccumulator& a, const GridAccumulator& b) {
  EXPECT_EQ(difference(a, b), "");
  EXPECT_EQ(a.photon_begin, b.photon_begin);
  EXPECT_EQ(a.photon_end, b.photon_end);
  EXPECT_EQ(a.counters, b.counters);
  EXPECT_EQ(a.sums, b.sums);
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t i = 0; i < a.groups.size(); ++i) EXPECT_EQ(a.groups[i].sums, b.groups[i].sums);
}

class Checkpoint : public FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    policy_.path = path("x.checkpoint.vdb");
    policy_.every_s = 1e9;  // none but where it stops
    policy_.on_event = [this](const CheckpointEvent& event) {
      if (event.kind != CheckpointEvent::Kind::writing) events_.push_back(event);
    };
  }

  // Stops it after 1 to 8 batches each time; returns how often.
  int bake_in_pieces(const LitScene& lit, GridBakeParams params, GridAccumulator& result) {
    std::uniform_int_distribution<int> batches(1, 8);
    for (int stops = 0;; ++stops) {
      int left = batches(random_);
      policy_.stop = [&] { return --left <= 0; };
      params.checkpoint = policy_;
      params.threads = 1 + stops % 2;
      try {
        result = bake_grid_sums(lit, params);
        return stops;
      } catch (const BakeStopped&) {
        EXPECT_TRUE(std::filesystem::exists(policy_.path));
      }
    }
  }

  CheckpointPolicy policy_;
  std::vector<CheckpointEvent> events_;
  std::mt19937 random_{7};
};

TEST_F(Checkpoint, GoesOnToTheSameSums) {
  const LitScene lit = make_lit_scene(room());
  std::vector<GridBakeParams> bakes(6, small_bake());
  bakes[1].levels = 2;
  bakes[2].groups = make_light_groups(lit.lights, *lit.scene, {{"weak", {"Weak"}}});
  bakes[3].photon_range = {{7'001, 50'003}};
  bakes[4].basis = Basis::sh9;
  bakes[4].emission = EmissionMode::even;
  bakes[5].estimator = Estimator::face;
  bakes[5].guard = Guard::off;
  for (std::size_t i = 0; i < bakes.size(); ++i) {
    SCOPED_TRACE(i);
    GridAccumulator pieces;
    EXPECT_GT(bake_in_pieces(lit, bakes[i], pieces), 1);
    expect_same(pieces, bake_grid_sums(lit, bakes[i]));
    std::filesystem::remove(policy_.path);
  }
}

// Sums that all threads share, which small grids have not, and those of each thread; with finer units, which weak
// lights beside strong ones have.
TEST_F(Checkpoint, SumsAreTakenAndPutBack) {
  const LitScene lit = make_lit_scene(room());
  const PhotonTracer tracer(lit, {});
  const LightGroups groups = make_light_groups(lit.lights, *lit.scene, {{"weak", {"Weak"}}});
  const Lattice lattice = default_lattice(*lit.scene, small_bake());
  const std::vector<std::uint64_t> masks = vertex_cell_masks(lit.intersector, lattice);
  const Lights::PhotonPower power = tracer.emission().photon_power();
  GridAccumulator first;
  for (const DepositBuffers buffers : {DepositBuffers::own, DepositBuffers::shared}) {
    for (const LightGroups* kept : {static_cast<const LightGroups*>(nullptr), &groups}) {
      for (const bool is_paused : {false, true}) {
        PhotonSums sums(tracer,
                        make_deposit_target(lattice, Basis::vectors, Estimator::track, power.strongest_lm, masks,
                                            max_fine_bits, power.heaviest_lm, buffers),
                        kept, 2);
        GridAccumulator out;
        for (std::uint64_t begin = 0; begin < 30'000;) {
          const std::uint64_t end = sums.trace(begin, 30'000, [&](std::uint64_t done) {
            EXPECT_LE(begin + done, 30'000);
            return is_paused && done > 5'000;
          });
          EXPECT_GT(end, begin);
          begin = end;
          sums.take(out);
          EXPECT_EQ(out.counters["photons_traced"], std::int64_t(end));  // those before the pause, and no others
          sums.put(out);
          EXPECT_TRUE(out.sums.empty());
        }
        sums.take(out);
        if (first.sums.empty()) first = out;
        EXPECT_EQ(out.sums, first.sums);
        EXPECT_EQ(out.counters, first.counters);
        EXPECT_EQ(out.groups.size(), kept == nullptr ? 0 : 2);
      }
    }
  }
}

// A finished range at hand is taken in, as if it had been baked with the rest.
TEST_F(Checkpoint, TakesInWhatIsAtHand) {
  const LitScene lit = make_lit_scene(room());
  GridBakeParams params = small_bake();
  params.pilot_for_photons = params.photons;
  const GridAccumulator whole = bake_grid_sums(lit, params);
  params.photon_range = {{0, 20'000}};
  GridAccumulator half = bake_grid_sums(lit, params);
  params.photon_range = {{20'000, 60'000}};
  expect_same(bake_grid_sums(lit, params, std::move(half)), whole);
}

TEST_F(Checkpoint, IsOfOneBake) {
  const LitScene lit = make_lit_scene(room());
  policy_.origin["version"] = std::string("1");
  policy_.stop = [] { return true; };
  GridBakeParams params = small_bake();
  params.checkpoint = policy_;
  EXPECT_THROW(bake_grid_sums(lit, params), BakeStopped);

  const auto message = [&](const GridBakeParams& other, const LitScene& scene) {
    try {
      bake_grid_sums(scene, other);
    } catch (const Error& error) {
      return std::string(error.what());
    } catch (const BakeStopped& stopped) {
      return "stopped: " + std::string(stopped.what());
    }
    return std::string("baked");
  };
  std::vector<std::pair<GridBakeParams, std::string>> others(9, {params, ""});
  others[0] = {params, "stopped"};
  others[0].first.threads = 1;
  others[1].first.photons = 60'001;
  others[1].second = "photons is 60000, here 60001";
  others[2].first.seed = 2;
  others[2].second = "seed";
  others[3].first.photon_range = {{0, 59'999}};
  others[3].second = "photon range";
  others[4].first.bounds = Box3f(V3f(-1, -1, -1), V3f(1, 1, 0.999F));
  others[4].second = "bounds";
  others[5].first.include_direct = true;
  others[5].second = "another command";
  others[6].first.checkpoint->origin["version"] = std::string("2");
  others[6].second = "version is 1, here 2";
  others[7].first.groups = make_light_groups(lit.lights, *lit.scene, {});
  others[7].second = "another command";
  others[8].first.pilot_for_photons = 70'000;
  others[8].second = "another command";
  for (std::size_t i = 0; i < others.size(); ++i) {
    const std::string said = message(others[i].first, lit);
    EXPECT_NE(said.find(others[i].second), std::string::npos) << i << ": " << said;
    EXPECT_NE(said.find(policy_.path), std::string::npos) << i << ": " << said;
  }
  Scene other = room();
  other.content_hash = "feed";
  EXPECT_NE(message(params, make_lit_scene(other)).find("scene_hash"), std::string::npos);
  // Hits that are the same everywhere are not those of this kind of CPU.
  EXPECT_NE(message(params, make_lit_scene(room(), {.portable = true})).find(", here any"), std::string::npos);
  EXPECT_NE(checkpoint_cpu(false), "any");

  // Given up where that is asked for.
  params.photons = 30'000;
  const GridAccumulator wanted = [&] {
    GridBakeParams plain = params;
    plain.checkpoint.reset();
    return bake_grid_sums(lit, plain);
  }();
  params.checkpoint->replace = true;
  params.checkpoint->stop = nullptr;
  events_.clear();
  expect_same(bake_grid_sums(lit, params), wanted);
  ASSERT_EQ(events_.size(), 1);
  EXPECT_EQ(events_[0].kind, CheckpointEvent::Kind::replaced);
}

TEST_F(Checkpoint, DamageIsRefused) {
  const LitScene lit = make_lit_scene(room());
  policy_.stop = [] { return true; };
  GridBakeParams params = small_bake();
  params.checkpoint = policy_;
  EXPECT_THROW(bake_grid_sums(lit, params), BakeStopped);
  const std::string whole = [&] {
    std::ifstream file(policy_.path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  std::vector<std::string> damaged = {"", "no grid at all", whole.substr(0, whole.size() / 2)};
  for (int i = 0; i < 20; ++i) {
    std::string bytes = whole;
    bytes[std::uniform_int_distribution<std::size_t>(0, bytes.size() - 1)(random_)] ^= char(1 << i % 8);
    damaged.push_back(std::move(bytes));
  }
  for (const std::string& bytes : damaged) {
    std::ofstream(policy_.path, std::ios::binary) << bytes;
    EXPECT_THROW(bake_grid_sums(lit, params), Error) << bytes.size();
  }
}

// The bake goes on without; who asks it to stop hears that nothing was kept.
TEST_F(Checkpoint, FullDisks) {
  const LitScene lit = make_lit_scene(room());
  GridBakeParams params = small_bake();
  const GridAccumulator wanted = bake_grid_sums(lit, params);
  policy_.every_s = 1e-6;
  params.checkpoint = policy_;
  {
    const FullDisk disk(1000);
    expect_same(bake_grid_sums(lit, params), wanted);
    ASSERT_FALSE(events_.empty());
    EXPECT_EQ(events_[0].kind, CheckpointEvent::Kind::failed);
    EXPECT_NE(events_[0].line.find(policy_.path), std::string::npos);
    params.checkpoint->stop = [] { return true; };
    EXPECT_THROW(bake_grid_sums(lit, params), Error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST(CheckpointClock, WritingTakesAHundredthAtMost) {
  CheckpointClock clock(0);
  EXPECT_TRUE(clock.is_due());
  clock.begin();
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(20)) {
  }
  const double seconds = clock.end();
  EXPECT_GE(seconds, 0.02);
  // Due a hundred times that later: two seconds, of which none has passed yet, and a test does not wait for.
  EXPECT_FALSE(clock.is_due());
}

}  // namespace
}  // namespace ivory
