// Files made to break a loader: cut off anywhere, with bytes turned over, with claims that no file
// could back. Each must end in Error or in a scene that holds together.
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/scene_check.h"
#include "tracer/gltf/loader.h"

namespace ivory {
namespace {

using nlohmann::json;

// The message, or "" for a file that loads (into a consistent scene, or the test fails).
std::string error_of(const std::string& path, const LoadParams& params = {}) {
  try {
    EXPECT_EQ(find_fault(load_gltf(path, params).scene), "");
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  } catch (const ParameterError& error) {
    return error.what();  // no animation is left to take a time of
  }
  return "";
}

std::string error_of_text(const std::string& text, const std::string& name = "hostile.gltf") {
  const std::string path = GltfBuilder::folder() + "/" + name;
  GltfBuilder::write_file(path, text);
  return error_of(path);
}

// A bit of everything: quantized, sparse, instanced, textured, lit, seen.
GltfBuilder make_rich_document() {
  GltfBuilder builder;
  for (const char* name : {"KHR_lights_punctual", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization"})
    builder.use_extension(name);
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}}};
  builder.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  builder.root["images"] = {
      {{"uri",
        "data:image/png;base64,"
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg=="}}};
  builder.root["textures"] = {{{"source", 0}}};
  builder.root["materials"] = {{{"normalTexture", {{"index", 0}}}, {"alphaMode", "MASK"}}};
  const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5F}});
  const int n = builder.add({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  const int t = builder.add(std::vector<V2f>{{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  const std::uint8_t colors[16] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 9};
  const int c = builder.add_accessor("VEC4", 5121, 4, builder.add_view(colors, 16), true);
  const std::uint16_t places[] = {3};
  const float values[] = {0, 2, 0};
  const int place_view = builder.add_view(places, 2);
  const int value_view = builder.add_view(values, 12);
  builder.root["accessors"][0]["sparse"] = {{"count", 1},
                                            {"indices", {{"bufferView", place_view}, {"componentType", 5123}}},
                                            {"values", {{"bufferView", value_view}}}};
  const int i = builder.add_indices({0, 1, 2, 0, 2, 3});
  const int mesh =
      builder.add_mesh({{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", t}, {"COLOR_0", c}}},
                        {"indices", i},
                        {"material", 0}});
  const int moves = builder.add({{0, 0, 0}, {3, 0, 0}});
  const int child =
      builder.add_node({{"mesh", mesh},
                        {"scale", {1, -2, 1}},
                        {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}}}},
                       false);
  builder.add_node({{"children", {child}}, {"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return builder;
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void set_word(std::string& text, std::size_t at, std::size_t value) {
  for (std::size_t i = 0; i < 4; ++i) text[at + i] = static_cast<char>(value >> (8 * i) & 0xFFU);
}

TEST(GltfHostile, CutOffAnywhere) {
  const GltfBuilder rich = make_rich_document();
  const std::string path = rich.write("rich");
  ASSERT_EQ(error_of(path), "");
  const std::string whole = read_file(path);
  for (std::size_t length = 0; length < whole.size(); length += 37)
    EXPECT_NE(error_of_text(whole.substr(0, length), "cut.glb"), "") << length;

  // The same with lengths that agree with the cut, so that it is found further in.
  const std::size_t json_end = 20 + (whole.find("BIN") - 4 - 20);
  for (std::size_t length = json_end - 4; length > 20; length -= 4) {
    std::string cut = whole.substr(0, length);
    set_word(cut, 8, length);
    set_word(cut, 12, length - 20);
    EXPECT_NE(error_of_text(cut, "cut.glb").find("not JSON"), std::string::npos) << length;
  }
  for (std::size_t length = whole.size() - 4; length >= json_end + 8; length -= 4) {
    std::string cut = whole.substr(0, length);
    set_word(cut, 8, length);
    set_word(cut, json_end, length - json_end - 8);
    EXPECT_NE(error_of_text(cut, "cut.glb").find("buffers[0]"), std::string::npos) << length;
  }
  // Buffers that agree as well: now views reach beyond them.
  for (std::size_t size = 1; size < rich.bytes.size(); size += 5) {
    GltfBuilder cut = rich;
    cut.bytes.resize(size);
    EXPECT_NE(error_of(cut.write("cut")).find("behind its buffer"), std::string::npos) << size;
  }
}

TEST(GltfHostile, BytesTurnedOver) {
  const std::string whole = read_file(make_rich_document().write("rich"));
  std::mt19937 random(1);
  int refused = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string damaged = whole;
    const int count = 1 + int(random() % 4);
    for (int k = 0; k < count; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    refused += error_of_text(damaged, "damaged.glb").empty() ? 0 : 1;
  }
  // Most hits are in the JSON and break it.
  EXPECT_GT(refused, 500);
}

// Numbers replaced by extreme ones, one place at a time: the file stays JSON, so the faults go deep.
TEST(GltfHostile, NumbersReplaced) {
  const GltfBuilder rich = make_rich_document();
  const json flat = rich.root.flatten();
  const json replacements = {-1,    0,   1,    2,     3,      255,     65536, 2147483647,    4294967295U,   1e18,
                             -1e18, 0.5, 1e30, 1e300, "text", nullptr, true,  json::array(), json::object()};
  int loaded = 0;
  int refused = 0;
  for (const auto& [pointer, value] : flat.items()) {
    for (const json& replacement : replacements) {
      GltfBuilder changed = rich;
      changed.root[json::json_pointer(pointer)] = replacement;
      SCOPED_TRACE(pointer + " = " + replacement.dump());
      (error_of(changed.write("replaced")).empty() ? loaded : refused) += 1;
    }
  }
  EXPECT_GT(loaded, 100);
  EXPECT_GT(refused, 1000);
}

// A triangle that a morph target, a joint and an animation of both move.
GltfBuilder make_moving_document() {
  GltfBuilder builder;
  const std::uint8_t joints[12] = {};
  const float times[] = {0, 1};
  const float weights[] = {0, 1};
  const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const int d = builder.add(std::vector<V3f>(3, V3f(0, 0, 1)));
  const int w = builder.add(std::vector<V4f>(3, V4f(1, 0, 0, 0)));
  const int j = builder.add_accessor("VEC4", 5121, 3, builder.add_view(joints, sizeof joints));
  const int bind = builder.add_accessor("MAT4", 5126, 1, builder.add_view(matrix, sizeof matrix));
  const int time = builder.add_accessor("SCALAR", 5126, 2, builder.add_view(times, sizeof times));
  const int weight = builder.add_accessor("SCALAR", 5126, 2, builder.add_view(weights, sizeof weights));
  const int turn = builder.add(std::vector<V4f>{{0, 0, 0, 1}, {0, 1, 0, 0}});
  builder.add_mesh(
      {{"attributes", {{"POSITION", p}, {"JOINTS_0", j}, {"WEIGHTS_0", w}}}, {"targets", {{{"POSITION", d}}}}});
  builder.add_node({{"mesh", 0}, {"skin", 0}, {"weights", {0.5}}});
  builder.add_node(json::object());
  builder.root["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", bind}}};
  builder.root["animations"] = {
      {{"samplers",
        {{{"input", time}, {"output", turn}}, {{"input", time}, {"output", weight}, {"interpolation", "STEP"}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}},
         {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  return builder;
}

TEST(GltfHostile, NumbersOfPosesReplaced) {
  const GltfBuilder moving = make_moving_document();
  LoadParams params;
  params.time_s = 0.5;
  ASSERT_EQ(error_of(moving.write("moving"), params), "");
  int loaded = 0;
  int refused = 0;
  const json flat = moving.root.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (pointer.starts_with("/bufferViews")) continue;  // as above
    for (const json& replacement :
         {json(-1), json(0), json(1), json(2), json(65536), json(1e30), json("text"), json()}) {
      GltfBuilder changed = moving;
      changed.root[json::json_pointer(pointer)] = replacement;
      SCOPED_TRACE(pointer + " = " + replacement.dump());
      (error_of(changed.write("replaced"), params).empty() ? loaded : refused) += 1;
    }
  }
  EXPECT_GT(loaded, 30);
  EXPECT_GT(refused, 200);
  // And the bytes: keys, matrices, joints, weights.
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    GltfBuilder changed = moving;
    for (int k = 0; k < 2; ++k) changed.bytes[random() % changed.bytes.size()] = std::uint8_t(random());
    error_of(changed.write("replaced"), params);
  }
}

TEST(GltfHostile, ClaimsWithoutData) {
  // Accessors of 2 billion elements: in a view of 12 bytes, in no view, and sparse on nothing.
  GltfBuilder view;
  const int p = view.add({{0, 0, 0}});
  view.root["accessors"][0]["count"] = 2000000000;
  view.add_node({{"mesh", view.add_mesh({{"attributes", {{"POSITION", p}}}})}});
  EXPECT_NE(error_of(view.write("claim_view")).find("reaches beyond"), std::string::npos);

  GltfBuilder none;
  const int zeros = none.add_accessor("VEC3", 5126, 2000000000, -1);
  none.add_node({{"mesh", none.add_mesh({{"attributes", {{"POSITION", zeros}}}})}});
  EXPECT_NE(error_of(none.write("claim_none")).find("without data"), std::string::npos);

  // Offsets whose sums overflow 64 bits.
  GltfBuilder overflow;
  const int q = overflow.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  overflow.root["bufferViews"][0]["byteOffset"] = 18446744073709551610ULL;
  overflow.add_node({{"mesh", overflow.add_mesh({{"attributes", {{"POSITION", q}}}})}});
  EXPECT_NE(error_of(overflow.write("claim_overflow")), "");

  // A buffer of a terabyte in a file of a kilobyte.
  EXPECT_NE(
      error_of_text(
          R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":1000000000000,"uri":"data:application/octet-stream;base64,AAAA"}]})")
          .find("says 1000000000000 bytes but has 3"),
      std::string::npos);
}

TEST(GltfHostile, Structure) {
  const std::string head = R"({"asset":{"version":"2.0"},)";
  EXPECT_NE(error_of_text(head + R"("extensionsRequired":["KHR_from_the_future"]})").find("KHR_from_the_future"),
            std::string::npos);
  EXPECT_NE(error_of_text(head + R"("nodes":[{"children":[1]},{"children":[0]}]})").find("loop"), std::string::npos);
  EXPECT_NE(error_of_text(head + R"("nodes":[{"children":[0]}]})").find("loop"), std::string::npos);
  EXPECT_NE(error_of_text(head + R"("nodes":[{"children":[1,1]},{}]})").find("child of"), std::string::npos);
  EXPECT_NE(error_of_text(head + R"("nodes":[{"mesh":0}]})").find("does not exist"), std::string::npos);
  // Names that would break the line.
  const std::string named = error_of_text(head + R"("nodes":[{"name":"a\nb\u001b[31m","children":[0]}]})");
  EXPECT_NE(named.find("a b [31m"), std::string::npos) << named;
  // A million brackets: no recursion may follow them.
  EXPECT_NE(
      error_of_text(head + "\"extras\":" + std::string(1000000, '[') + std::string(1000000, ']') + "}").find("nested"),
      std::string::npos);
  EXPECT_NE(error_of_text(std::string(1000000, '[')), "");
  EXPECT_NE(error_of_text(""), "");
  EXPECT_NE(error_of_text("null"), "");
  EXPECT_NE(error_of_text("\xFF\xFE{}"), "");
  EXPECT_NE(error_of(GltfBuilder::folder()).find("not a regular file"), std::string::npos);
  EXPECT_NE(error_of("/dev/zero").find("not a regular file"), std::string::npos);
  EXPECT_NE(error_of(GltfBuilder::folder() + "/nowhere.gltf").find("no such file"), std::string::npos);
  // A chain of a hundred thousand nodes is deep, but no fault.
  json chain = json::parse(head + R"("nodes":[]})");
  for (int i = 0; i < 100000; ++i)
    chain["nodes"].push_back(i + 1 < 100000 ? json{{"children", {i + 1}}} : json::object());
  EXPECT_EQ(error_of_text(chain.dump()), "");
}

TEST(GltfHostile, DamagedDraco) {
  const std::string folder = sample_data();
  if (folder.empty()) GTEST_SKIP() << no_sample_data;
  const std::string source = folder + "/gltf/Box/glTF-Draco/";
  const std::string path = GltfBuilder::folder() + "/DracoBox.gltf";
  json root = json::parse(read_file(source + "Box.gltf"));
  root["buffers"][0]["uri"] = "DracoBox.bin";
  GltfBuilder::write_file(path, root.dump());
  const std::string whole = read_file(source + "Box.bin");
  const std::string bin = GltfBuilder::folder() + "/DracoBox.bin";
  GltfBuilder::write_file(bin, whole);
  ASSERT_EQ(error_of(path), "");
  std::mt19937 random(2);
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    for (int k = 0; k < 1 + int(random() % 3); ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    GltfBuilder::write_file(bin, damaged);
    error_of(path);
  }
}

}  // namespace
}  // namespace ivory
