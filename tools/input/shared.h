// Scenes and environments that several commands of one process read: each is loaded once, with its tree of triangles
// and its lights, and given up when nobody is left who needs it.
#pragma once

#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "tools/input/environment.h"
#include "tools/input/scene.h"

namespace ivory {

// Values by name, each made once by whoever asks first; who asks meanwhile waits. Thread-safe.
template <typename T>
class MadeOnce {
 public:
  // `file`: what keep_only() goes by. What `make` throws is thrown at all who wait, and forgotten.
  std::shared_ptr<const T> get(const std::string& key, const std::string& file, const std::function<T()>& make) {
    std::promise<std::shared_ptr<const T>> promise;
    std::shared_future<std::shared_ptr<const T>> made;
    bool first = false;
    {
      const std::scoped_lock lock(mutex_);
      auto found = entries_.find(key);
      if (found == entries_.end()) {
        first = true;
        found = entries_.emplace(key, Entry{file, promise.get_future().share()}).first;
      }
      made = found->second.value;
    }
    if (!first) return made.get();
    try {
      promise.set_value(std::make_shared<const T>(make()));
    } catch (...) {
      promise.set_exception(std::current_exception());
      const std::scoped_lock lock(mutex_);
      entries_.erase(key);
    }
    return made.get();
  }
  // Gives up what comes from other files; who holds it keeps it.
  void keep_only(const std::set<std::string>& files) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(entries_, [&](const auto& entry) { return !files.contains(entry.second.file); });
  }

 private:
  struct Entry {
    std::string file;
    std::shared_future<std::shared_ptr<const T>> value;
  };
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

class SharedInputs {
 public:
  MadeOnce<SceneInput> lit;  // with their environments
  MadeOnce<LoadedScene> scenes;
  MadeOnce<EnvironmentInput> environments;

  // Gives up what comes from files other than these, named as the commands name them.
  void keep_only(const std::set<std::string>& files) {
    lit.keep_only(files);
    scenes.keep_only(files);
    environments.keep_only(files);
  }
};

}  // namespace ivory
