#pragma once
// The pictures that were rendered for a page: what `inspect`, `display` and `save` refer to.

#include "core/image.h"
#include "render/render.h"

#include <deque>
#include <memory>
#include <mutex>

namespace nacre {

/// A picture while it is made and after. Thread-safe.
class Picture {
public:
  explicit Picture(Scene scene);

  const Scene& scene() const { return scene_; }
  const Renderer& renderer() const { return renderer_; }

  /// @param image  R, G, B and variance.R, variance.G, variance.B
  void show(std::shared_ptr<const Image> image, double samples_per_pixel);
  struct Shown {
    std::shared_ptr<const Image> image; ///< null before the first pass
    double samples_per_pixel = 0;
  };
  Shown shown() const;

private:
  Scene scene_;
  Renderer renderer_; ///< of scene_
  mutable std::mutex mutex_;
  Shown shown_;
};

/// The last few pictures of one page, by the id of the request that made them. Thread-safe.
class PictureStore {
public:
  void keep(std::int64_t id, std::shared_ptr<Picture> picture);
  /// @throws Error if there is none, or none any more
  std::shared_ptr<Picture> find(std::int64_t id) const;

private:
  static constexpr std::size_t most = 6;
  struct Entry {
    std::int64_t id;
    std::shared_ptr<Picture> picture;
  };
  mutable std::mutex mutex_;
  std::deque<Entry> entries_;
};

} // namespace nacre
