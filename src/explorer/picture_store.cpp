#include "explorer/picture_store.h"

#include "core/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace nacre {

Picture::Picture(Scene scene) : scene_(std::move(scene)), renderer_(scene_) {}

void Picture::show(std::shared_ptr<const Image> image, double samples_per_pixel) {
  const std::lock_guard lock(mutex_);
  shown_ = {std::move(image), samples_per_pixel};
}

Picture::Shown Picture::shown() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

void PictureStore::keep(std::int64_t id, std::shared_ptr<Picture> picture) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const Entry& e) { return e.id == id; });
  entries_.push_back({id, std::move(picture)});
  if (entries_.size() > most) entries_.pop_front();
}

std::shared_ptr<Picture> PictureStore::find(std::int64_t id) const {
  const std::lock_guard lock(mutex_);
  for (const Entry& e : entries_)
    if (e.id == id) return e.picture;
  throw Error(fmt::format("there is no picture of request {}; the last {} are kept", id, most));
}

} // namespace nacre
