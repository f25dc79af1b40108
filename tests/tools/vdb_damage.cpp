// Damaged .vdb files that no checksum guards: whatever OpenVDB does over them, the command line says one line.
#include <csignal>
#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "grid/base/error.h"
#include "grid/io/vdb/vdb.h"
#include "tests/support/io_random.h"
#include "tools/input/vdb/load.h"
#include "tools/input/vdb/trial.h"

namespace ivory {
namespace {

using namespace ivory::test;

TEST(VdbInput, DamageWithoutChecksum) {
  const auto folder = scratch_folder("vdb_damage");
  const std::string path = folder / "damaged.vdb";
  write_vdb(path, random_grid(21, Basis::sh4), false);
  const IrradianceGrid grid = read_grid_vdb(path);
  std::string bytes = read_bytes(path);
  bytes.replace(21, 36, "01234567-89ab-4def-8123-456789abcdef");  // the UUID of a file that OpenVDB wrote
  write_bytes(path, bytes);
  EXPECT_TRUE(load_grid_vdb(path).moments == grid.moments);
  std::mt19937 rng(9);
  for (int trial = 0; trial < 150; ++trial) {
    std::string damaged = bytes;
    if (trial % 3 == 0) {
      damaged.resize(57 + rng() % (bytes.size() - 57));
    } else {
      char& victim = damaged[rng() % (trial % 3 == 1 ? 6000 : bytes.size())];
      victim = char(victim ^ (1 << (rng() % 8)));
    }
    write_bytes(path, damaged);
    try {
      load_grid_vdb(path);  // values that changed without a trace are read as they are
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with(path + ": ")) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
}

TEST(Trial, TellsCrashesFromAnswers) {
  using Kind = TrialOutcome::Kind;
  const auto kind_of = [](const std::function<std::string()>& action) { return run_trial(64U << 20U, action).kind; };
  const TrialOutcome returned = run_trial(64U << 20U, [] { return std::string(1'000'000, 'x'); });
  EXPECT_EQ(returned.kind, Kind::returned);
  EXPECT_EQ(returned.text, std::string(1'000'000, 'x'));
  const TrialOutcome threw = run_trial(64U << 20U, []() -> std::string { throw std::runtime_error("why"); });
  EXPECT_EQ(threw.kind, Kind::threw);
  EXPECT_EQ(threw.text, "why");
  EXPECT_EQ(kind_of([]() -> std::string { std::abort(); }), Kind::crashed);
  EXPECT_EQ(kind_of([] { return std::raise(SIGSEGV) == 0 ? "" : ""; }), Kind::crashed);
  EXPECT_EQ(kind_of([]() -> std::string { throw std::bad_alloc(); }), Kind::crashed);
  EXPECT_EQ(kind_of([] { return read_bytes("/dev/zero"); }), Kind::crashed);

  // What cannot be tried is not called damaged.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const Kind without_pipe = kind_of([] { return std::string("never"); });
  ::setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(without_pipe, Kind::not_started);
}

}  // namespace
}  // namespace ivory
