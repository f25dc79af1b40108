// Job files with mistakes: each ends in one line that names file, line, column and what was expected, and bakes
// nothing.
#include "tests/tools/batch/batch_test.h"

namespace ivory {
namespace {

struct Mistake {
  const char* what;
  std::string text;   // of job.toml
  const char* place;  // line:column
  const char* says;   // among else
};

// Three lines that are right: what follows is line 3 onwards.
const std::string grid = "[grid.a]\nscene = \"cornell_box.gltf\"\n";
const std::string picture = "[render.a]\nscene = \"cornell_box.gltf\"\n";
const std::string table = "[fiv.a]\nmesh = \"tile.gltf\"\nenv = \"sky.hdr\"\n";
const std::string box = "[scene.box]\nfile = \"cornell_box.gltf\"\n";

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all{
      // TOML
      {"no value", "[grid.a]\nscene =\n", "2:8", "expected value"},
      {"text without end", "[grid.a]\nscene = \"cornell_box.gltf\n", "2:26", "TOML"},
      {"header without end", "[grid.a\nscene = \"x\"\n", "1:8", "expected ']'"},
      {"key twice", grid + "scene = \"b\"\n", "3:9", "redefine"},
      {"section twice", grid + grid, "3:1", "redefine"},
      {"quote in a key", "[grid.a]\n\"scene = \"x\"\n", "2:11", "expected '='"},
      {"no UTF-8", "[grid.a]\nscene = \"\xff\xfe\"\n", "2:9", "utf-8"},
      {"a date", grid + "seed = 2020-01-01\n", "3:8", "date"},
      {"nothing", "", "1:1", "names nothing to bake"},
      {"a comment alone", "# all to come\n", "1:1", "[grid.hall]"},
      // Sections
      {"unknown kind", "[gird.a]\nscene = \"cornell_box.gltf\"\n", "1:2", "did you mean 'grid'"},
      {"kind as a value", "grid = 3\n", "1:8", "[grid.NAME]"},
      {"section as a value", "[grid]\na = 3\n", "2:5", "[grid.NAME]"},
      {"no name", "[grid]\nscene = \"cornell_box.gltf\"\n", "2:9", "[grid.NAME]"},
      {"default of no kind", "[default.gird]\nphotons = \"1k\"\n" + grid, "1:10", "did you mean 'grid'"},
      {"default of no option", "[default.grid]\nphotos = \"1k\"\n" + grid, "2:1", "did you mean 'photons'"},
      {"bad default", "[default.grid]\nvoxel_size = -1\n" + grid, "2:14", "not a number above 0"},
      {"unknown setting", "[job]\nouptut = \"x\"\n" + grid, "2:1", "did you mean 'output'"},
      {"folder as a number", "[job]\noutput = 3\n" + grid, "2:10", "output = \"baked\""},
      {"variables as a value", "variables = 3\n" + grid, "1:13", "[variables]"},
      // Includes and variables
      {"include of nothing", "include = [\"other.toml\"]\n" + grid, "1:12", "other.toml' to include"},
      {"include of a number", "include = 3\n" + grid, "1:11", "include = "},
      {"include of itself", "include = [\"job.toml\"]\n" + grid, "1:12", "includes itself"},
      {"unknown variable", grid + "voxel_size = \"${vx}\"\n", "3:14", "no variable 'vx'"},
      {"variable like another", "[variables]\nvoxel = 1\n" + grid + "voxel_size = \"${voxl}\"\n", "5:14",
       "did you mean 'voxel'"},
      {"variable without end", grid + "voxel_size = \"${vx\"\n", "3:14", "has no }"},
      {"ring of variables", "[variables]\na = \"${b}\"\nb = \"${a}\"\n" + grid + "voxel_size = \"${a}\"\n", "3:5",
       "stands for itself"},
      {"table within a text", "[variables]\na = { b = 1 }\n" + grid + "env = \"x${a}\"\n", "5:7", "is a table"},
      // Scenes and environments
      {"scene without file", "[scene.box]\nscale = 2\n", "1:8", "lacks 'file'"},
      {"scene of no file", "[scene.box]\nfile = \"nothing.glb\"\n", "2:8", "no file 'nothing.glb'"},
      {"scene with what it has not", box + "scael = 2\n", "3:1", "did you mean 'scale'"},
      {"scene scaled below 0", box + "scale = -2\n[grid.a]\nscene = \"box\"\n", "3:9", "not a number from"},
      {"environment scaled", "[environment.sky]\nfile = \"sky.hdr\"\nscale = 2\n", "3:1", "known are file, layout"},
      {"unknown layout", "[environment.sky]\nfile = \"sky.hdr\"\nlayout = \"round\"\n[sh9.a]\nenvironment = \"sky\"\n",
       "3:10", "one of latlong"},
      // Options
      {"unknown option", grid + "voxel_sise = 0.2\n", "3:1", "did you mean 'voxel_size'"},
      {"an option of the batch", grid + "dry_run = true\n", "3:1", "no option of grid"},
      {"scene missing", "[grid.a]\nphotons = \"1k\"\n", "1:7", "lacks 'scene'"},
      {"environment missing", "[fiv.a]\nmesh = \"tile.gltf\"\n", "1:6", "lacks 'env'"},
      {"place missing", "[cubemap.a]\nscene = \"cornell_box.gltf\"\n", "1:10", "lacks 'at'"},
      {"output missing", "[sh9.a]\nenvironment = \"sky.hdr\"\n[export.a]\nasset = \"a\"\nto = \"three.js\"\n", "3:9",
       "lacks 'output'"},
      {"a word for a number", grid + "voxel_size = \"wide\"\n", "3:14", "'voxel_size' is METRES"},
      {"below 0", grid + "voxel_size = -1\n", "3:14", "not a number above 0"},
      {"seconds for metres", grid + "voxel_size = \"20 s\"\n", "3:14", "units of mm, cm, m, km"},
      {"unknown unit", grid + "voxel_size = \"20 inch\"\n", "3:14", "units of mm, cm, m, km"},
      {"no such basis", grid + "basis = \"sh10\"\n", "3:9", "vectors,vectors9,sh9"},
      {"true for a number", grid + "voxel_size = true\n", "3:14", "METRES"},
      {"a text for a flag", grid + "direct = \"yes\"\n", "3:10", "write true or false"},
      {"a table for a number", grid + "voxel_size = { x = 1 }\n", "3:14", "is a table"},
      {"an empty list", grid + "groups = []\n", "3:10", "empty list"},
      {"an empty text", grid + "env = \"\"\n", "3:7", "empty text"},
      {"half a box", grid + "bounds = [0, 1, 2]\n", "3:10", "X0,Y0,Z0:X1,Y1,Z1"},
      {"a flat box", grid + "bounds = \"0,0,0:1,1,0\"\n", "3:10", "extent along each axis"},
      {"two coordinates", "[cubemap.a]\nscene = \"cornell_box.gltf\"\nat = [0, 1]\n", "3:6", "X,Y,Z"},
      {"options that exclude each other", grid + "voxel_size = 0.1\nresolution = 8\n", "4:14", "excludes"},
      {"more photons than there are", grid + "photons = \"1k\"\nvoxel_size = 0.1\nphoton_range = \"0:2k\"\n", "5:16",
       "past the 1000"},
      {"an option that needs another", grid + "voxel_size = 0.1\nphotons = \"1k\"\nmax_time = 10\n", "5:12",
       "serves target_error"},
      {"more than all", grid + "target_error = \"200%\"\n", "3:16", "between 0 and 100 %"},
      {"half a photon", grid + "photons = \"1.5\"\nresolution = 8\n", "3:11", "a whole number"},
      {"no photon", grid + "photons = 0\nresolution = 8\n", "3:11", "at least 1"},
      {"groups without a name", grid + "voxel_size = 0.1\ngroups = [\"=x\"]\n", "4:10", "GROUP=PATTERN"},
      {"no box", grid + "voxel_size = 0.1\ndynamic = \"all\"\n", "4:11", "none or a box"},
      {"no kind of light", grid + "voxel_size = 0.1\ndirect_of = \"moon\"\n", "4:13", "punctual, area, sky"},
      {"two azimuths", table + "samples = \"2,1,1\"\n", "4:11", "NX,NY,NZ"},
      {"three hemispheres", table + "hemispheres = 3\n", "4:15", "{1,6}"},
      {"half a size", picture + "size = \"640\"\n", "3:8", "640x480"},
      {"a method without its grid", picture + "method = \"gather\"\n", "3:10", "needs grid"},
      {"a method without its environment", picture + "method = \"fiv\"\n", "3:10", "fiv"},
      {"no such target",
       "[sh9.a]\nenvironment = \"sky.hdr\"\n[export.a]\nasset = \"a\"\nto = \"three\"\noutput = \"x.json\"\n", "5:6",
       "three.js,babylon.js"},
      {"a target of other files",
       "[sh9.a]\nenvironment = \"sky.hdr\"\n[export.a]\nasset = \"a\"\nto = \"usd\"\noutput = \"x.json\"\n", "5:6",
       "ivory export --help"},
      // Files and assets
      {"no such scene", "[grid.a]\nscene = \"cornel_box.gltf\"\n", "2:9", "neither a file nor a name"},
      {"a scene's name, nearly", box + "[grid.a]\nscene = \"bx\"\n", "4:9", "did you mean 'box'"},
      {"a folder for a scene", "[grid.a]\nscene = \".\"\n", "2:9", "neither a file nor a name"},
      {"no such asset", "[export.a]\nasset = \"b\"\nto = \"three.js\"\noutput = \"x.json\"\n", "2:9",
       "an asset of the job"},
      {"no such object", picture + "object = \"nothing.glb@0,0,0\"\n", "3:10", "neither a file nor a name"},
      {"no such points", grid + "target_error = 0.05\nerror_points = \"nothing.csv\"\n", "4:16", "nothing.csv"},
      {"another's extension", grid + "output = \"x.exr\"\n", "3:10", "does not end in .vdb"},
      {"no kind of picture", picture + "output = \"a.xyz\"\n", "3:10", "no extension of an image format"},
      {"one file of two", grid + "output = \"x.vdb\"\n[grid.b]\nscene = \"cornell_box.gltf\"\noutput = \"x.vdb\"\n",
       "4:7", "as [grid.a] does"},
      {"a ring of assets", "[mix.a]\ngrid = \"b\"\n[mix.b]\ngrid = \"a\"\n", "1:6", "mix.a needs mix.b needs mix.a"},
      {"an asset that needs itself", "[mix.a]\ngrid = \"a\"\n", "1:6", "needs itself"},
      {"one name of two",
       grid + "[mix.a]\ngrid = \"grid.a\"\n" + "[render.b]\nscene = \"cornell_box.gltf\"\ngrid = \"a\"\n", "7:8",
       "grid.a or mix.a"},
      {"a pattern of no assets", "[merge.a]\nparts = [\"grid.rooms.*\"]\n", "2:9", "no asset matches"},
      // Patterns
      {"a pattern of no files", "[spheres.a]\neach = \"models/*.glb\"\nmesh = \"${file}\"\n", "2:8", "no file matches"},
      {"each number", "[spheres.a]\neach = 3\nmesh = \"${file}\"\n", "2:8", "a pattern of files"},
      {"nodes of no scene", "[grid.a]\neach = { scene = \"level\", nodes = \"R*\" }\nscene = \"level\"\n", "2:18",
       "no [scene.level]"},
      {"no such nodes", box + "[grid.a]\neach = { scene = \"box\", nodes = \"Rm*\" }\nscene = \"box\"\n", "4:33",
       "no node with triangles"},
      {"nodes by another word", box + "[grid.a]\neach = { scene = \"box\", node = \"*\" }\nscene = \"box\"\n", "4:25",
       "nodes = \"Room*\""},
      {"a list of this and that", "[grid.a]\neach = [\"a\", 3]\nscene = \"cornell_box.gltf\"\n", "2:14", "list texts"},
      {"each twice", "[grid.a]\neach = [\"a\", \"a\"]\nscene = \"cornell_box.gltf\"\n", "2:8", "two that are called"},
      {"without nothing", grid + "without = [\"Chair*\"]\nvoxel_size = 0.1\n", "3:11", "no node with triangles"},
  };
  return all;
}

class Mistakes : public BatchTest {};

TEST_F(Mistakes, EndInOneLineThatSaysWhere) {
  ASSERT_GE(mistakes().size(), 50U);
  for (const Mistake& mistake : mistakes()) {
    SCOPED_TRACE(mistake.what);
    write("job.toml", mistake.text);
    const RunResult result = batch();
    EXPECT_EQ(result.exit_code, 1) << result.output;
    EXPECT_TRUE(result.output.starts_with("ivory: " + path("job.toml") + ":" + mistake.place + ": ")) << result.output;
    EXPECT_NE(result.output.find(mistake.says), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("; "), std::string::npos) << result.output;
    EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 1) << result.output;
  }
  // Nothing is left of any.
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"cornell_box.gltf", "job.toml", "sky.hdr", "tile.gltf"}));
}

// In an included file, by that file's name and lines.
TEST_F(Mistakes, AreFoundInIncludedFiles) {
  write("parts/common.toml", "# defaults\n[default.grid]\nvoxel_size = \"20 s\"\n");
  write("job.toml", "include = [\"parts/common.toml\"]\n" + grid);
  EXPECT_NE(batch().output.find("parts/common.toml:3:14: '20 s'"), std::string::npos) << batch().output;
  write("parts/common.toml", grid);
  EXPECT_NE(batch().output.find("job.toml:2:7: [grid.a] is already at"), std::string::npos) << batch().output;
}

TEST_F(Mistakes, OnTheCommandLine) {
  write("job.toml", "[variables]\nv = 0.1\n" + grid + "voxel_size = \"${v}\"\n");
  const std::string job = "batch " + path("job.toml") + " ";
  expect_one_line("batch " + path("none.toml"), 1, "cannot be read");
  expect_one_line(job + "--only 'fiv.*'", 2, "no asset 'fiv.*'");
  expect_one_line(job + "--set w=3", 2, "no variable 'w'");
  expect_one_line(job + "--set v", 2, "NAME=VALUE");
  expect_one_line(job + "--list --dry-run", 2, "do not go together");
  expect_one_line(job + "--explain fiv.a", 2, "no asset 'fiv.a'");
  expect_one_line(job + "--init " + path("cornell_box.gltf"), 1, "already exists");
}

}  // namespace
}  // namespace ivory
