# Writes OUTPUT, a C++ file that holds the text of each file of the list SHADERS in FOLDER; see
# runtime/gl/shader_source.cpp.
set(text "// Made by tools/cmake/EmbedShaders.cmake.\n#include \"runtime/gl/shader_table.h\"\n\nnamespace ivory {\n\n")
string(APPEND text "const std::vector<EmbeddedShader>& embedded_shaders() {\n  static const std::vector<EmbeddedShader> shaders{\n")
foreach(shader IN LISTS SHADERS)
  file(READ ${FOLDER}/${shader} source)
  string(APPEND text "    {\"${shader}\", R\"GLSL(${source})GLSL\"},\n")
endforeach()
string(APPEND text "  };\n  return shaders;\n}\n\n}  // namespace ivory\n")
file(WRITE ${OUTPUT} "${text}")
