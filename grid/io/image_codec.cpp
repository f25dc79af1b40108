#include "grid/io/image_codec.h"

#include <dlfcn.h>

#include "grid/base/error.h"

namespace ivory {

const ImageCodec& image_codec() {
  static const ImageCodec* const codec = [] {
    constexpr const char* name = "ivory_images.so";  // looked for along the program's RUNPATH
    void* module = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);
    void* get = module != nullptr ? ::dlsym(module, "ivory_image_codec") : nullptr;
    if (get == nullptr) {
      throw Error(name, std::string("cannot be loaded (") + ::dlerror() + ")",
                  "give it more memory and files to open (ulimit -v, -n), or install ivory again");
    }
    return reinterpret_cast<const ImageCodec* (*)()>(get)();
  }();
  return *codec;
}

}  // namespace ivory
