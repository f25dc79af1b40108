// ivory export SCENE --grid G.vdb --to web: a folder that any static server shows, without a network.
#pragma once

namespace ivory {

struct ExportOptions;
struct CommonOptions;

// Writes the folder options.output and prints the result.
void export_web(const ExportOptions& options, const CommonOptions& common);

}  // namespace ivory
