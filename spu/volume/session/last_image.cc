// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/session/last_image.h"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "compositor/rendered.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using volume::RenderRequest;

constexpr std::size_t remembered = 4;

/// Returns which part of a request has changed.
std::string_view changed_part(const RenderRequest& now, const RenderRequest& then) {
  if (now.version != then.version) return "texels changed";
  if (now.viewport != then.viewport || now.window != then.window) return "the window changed";
  if (now.texture_to_clip != then.texture_to_clip) return "the camera moved";
  if (!(now.classification == then.classification)) return "colours changed";
  if (now.depth != then.depth) return "opaque geometry changed";
  return "samples or cuts changed";
}

class LastImage final : public compositor::RenderService {
 public:
  LastImage(std::unique_ptr<compositor::RenderService> service, bool keeps, ImageNews news)
      : service_(std::move(service)), keeps_(keeps), news_(std::move(news)) {
    answers_.reserve(remembered);
  }

  void begin_volume(const volume::VolumeDescription& volume) override {
    forget_images();
    service_->begin_volume(volume);
  }
  void begin_change(volume::VolumeId id, std::uint64_t version) override {
    forget_images();
    service_->begin_change(id, version);
  }
  void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                  std::span<const std::byte> texels) override {
    forget_images();
    service_->add_texels(id, boxes, texels);
  }
  void end_volume(volume::VolumeId id) override {
    forget_images();
    service_->end_volume(id);
  }
  void forget_volume(volume::VolumeId id) override {
    forget_images();
    service_->forget_volume(id);
  }

  compositor::Rendered render(const RenderRequest& request) override {
    const auto same = std::find_if(answers_.begin(), answers_.end(), [&](Answer& answer) {
      answer.request.exact = request.exact;
      return answer.request == request;
    });
    const bool known = same != answers_.end();
    // Nodes may have rounded an image that was not to be exact (--pixels).
    const bool lossy = known && (same->lossy || (request.exact && !same->exact));
    if (known && same->there && !lossy && keeps_ && getpid() == process_) {
      news_("");
      return {same->shown, {}, true};
    }
    const std::string_view why = !keeps_ ? "asked to"
                                 : lossy ? "it was lossy before"
                                 : known ? "others were asked for since"
                                         : reason_for(request);
    for (Answer& answer : answers_) answer.there = answer.there && !answer.kept.rgba.empty();
    compositor::Rendered rendered = service_->render(lossy ? volume::exactly(request) : request);
    news_(why);
    Answer& answer = known ? *same : place_for_another();
    if (!known) answer.request = request;
    // A viewer that requests several images in turn gets copies: the service keeps only its last image.
    answer.kept = known && keeps_ ? copy_of(rendered.image) : volume::Image();
    answer.shown = known && keeps_ ? answer.kept.view() : rendered.image;
    answer.there = true;
    answer.lossy = rendered.lossy;
    answer.exact = request.exact || lossy;
    answer.asked = ++asked_;
    rendered.image = answer.shown;
    return rendered;
  }

  std::vector<volume::PixelIntegral> integrals(const RenderRequest& request,
                                               std::span<const volume::Pixel> pixels, double most_ms) override {
    return service_->integrals(request, pixels, most_ms);
  }

  int nodes() const override { return service_->nodes(); }

 private:
  struct Answer {
    RenderRequest request;
    volume::ImageView shown;
    volume::Image kept;  ///< the image shown, if it is a copy
    bool there = false;
    bool lossy = false;
    bool exact = false;       ///< as it was cast
    std::uint64_t asked = 0;  ///< number of the request
  };

  void forget_images() {
    for (Answer& answer : answers_) answer.there = false;
  }

  std::string_view reason_for(const RenderRequest& request) const {
    const Answer* last = nullptr;
    for (const Answer& answer : answers_)
      if (answer.request.volume == request.volume && (last == nullptr || answer.asked > last->asked))
        last = &answer;
    return last == nullptr ? "the first of its volume" : changed_part(request, last->request);
  }

  Answer& place_for_another() {
    if (answers_.size() < remembered) return answers_.emplace_back();
    return *std::min_element(answers_.begin(), answers_.end(),
                             [](const Answer& a, const Answer& b) { return a.asked < b.asked; });
  }

  std::unique_ptr<compositor::RenderService> service_;
  bool keeps_;
  pid_t process_ = getpid();  ///< after a fork() images belong to the parent, whose nodes overwrite them
  ImageNews news_;
  std::vector<Answer> answers_;  ///< never reallocated: images are used in place
  std::uint64_t asked_ = 0;
};

}  // namespace

std::unique_ptr<compositor::RenderService> with_last_image(std::unique_ptr<compositor::RenderService> service,
                                                           bool keeps, ImageNews news) {
  return std::make_unique<LastImage>(std::move(service), keeps, std::move(news));
}

}  // namespace understudy::spu
