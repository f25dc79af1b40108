#include "tools/input/vdb/load.h"

#include <filesystem>

#include "grid/base/error.h"
#include "grid/field/resolve.h"
#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/seal.h"
#include "grid/io/vdb/vdb.h"
#include "tools/input/vdb/trial.h"

namespace ivory {

namespace {

// read(path, copy), where a child process has made the copy of what bears no checksum.
template <typename Read>
auto read_safely(const std::string& path, const Read& read) {
  if (is_sealed_vdb(path)) return read(path, std::string());
  // Room for every byte of the file to unpack into 256.
  const std::uint64_t memory_bytes = (std::filesystem::file_size(path) + (1U << 20U)) * 256;
  const TrialOutcome trial = run_trial(memory_bytes, [&] { return resave_vdb(path); });
  if (trial.kind == TrialOutcome::Kind::not_started) {
    throw Error(path, "bears no checksum of ivory and cannot be tried in a process of its own",
                "allow more processes, memory and files to open (ulimit -u, -v, -n)");
  }
  if (trial.kind == TrialOutcome::Kind::crashed)
    throw Error(path, "is damaged", "save it again from the program that wrote it");
  if (trial.kind == TrialOutcome::Kind::threw)
    throw Error(path, "OpenVDB reports " + trial.text, "give a .vdb file that ivory baked");
  return read(path, MemoryFile(trial.text).path());
}

}  // namespace

IrradianceGrid load_grid_vdb(const std::string& path, bool with_groups) {
  return read_safely(
      path, [&](const std::string& p, const std::string& copy) { return read_grid_vdb(p, copy, with_groups); });
}

GridAccumulator load_accumulator_vdb(const std::string& path) { return read_safely(path, read_accumulator_vdb); }

IrradianceGrid load_grid_or_sums_vdb(const std::string& path, bool with_groups) {
  if (find_text(load_vdb_info(path), "kind") != vdb_accumulator_kind) return load_grid_vdb(path, with_groups);
  const GridAccumulator sums = load_accumulator_vdb(path);
  IrradianceGrid grid = with_groups ? resolve_groups(sums) : resolve(sums);
  grid.metadata["photon_begin"] = std::int64_t(sums.photon_begin);
  grid.metadata["photon_end"] = std::int64_t(sums.photon_end);
  return grid;
}

Metadata load_vdb_info(const std::string& path) { return read_safely(path, read_vdb_info); }

}  // namespace ivory
