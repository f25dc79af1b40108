// ivory render --checkpoint: the sums of an unfinished picture beside it, as a picture to look at.
#pragma once

#include <optional>
#include <string>

#include "tools/bake/checkpoint.h"
#include "tracer/render/render.h"

namespace ivory {

// An OpenEXR file whose channels R, G, B are the mean so far, and whose others are what the sums are made of;
// `identity` says of what picture.
void write_film_sums(const std::string& path, const FilmSums& sums, const Metadata& identity);
struct StoredSums {
  FilmSums sums;
  Metadata identity;
};
// Throws Error for other files and damaged ones.
StoredSums read_film_sums(const std::string& path);

// Lets a picture be kept and gone on from, as `policy` says; its origin is all that decides the picture. `params` is
// completed; what it calls lives as long as this.
class PictureCheckpoint {
 public:
  // Reads what is there. Throws Error where that is another picture's or damaged, unless policy.replace.
  PictureCheckpoint(const CheckpointPolicy& policy, RenderParams& params);

 private:
  std::string fault(const StoredSums& found, const RenderParams& params) const;
  void pause(const FilmSums& sums);

  CheckpointPolicy policy_;
  CheckpointClock clock_;
  bool is_to_stop_ = false;
};

}  // namespace ivory
