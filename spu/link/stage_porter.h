// Porters between viewers and stages (compositor/tcp/porter.h). What they add is JPEG: with a quality in the
// client's wishes, pictures travel as JPEG while frames follow each other, and what was lost of them comes as
// it is once the view rests: with a frame that changes nothing, or when there was none for rest_after.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <vector>

#include "compositor/tcp/porter.h"
#include "spu/link/travelling_picture.h"

namespace understudy::spu {

constexpr std::chrono::milliseconds rest_after{150};

/// Beside the viewer.
class ViewerPorter : public compositor::Porter {
 public:
  using Porter::Porter;

 protected:
  void carry_home(compositor::Message message) override;
};

/// Beside the stage.
class StagePorter : public compositor::Porter {
 public:
  StagePorter(compositor::Connection& here, compositor::TcpLink& link, const compositor::LinkWishes& wishes)
      : Porter(here, link), quality_(wishes.jpeg_quality) {}

 protected:
  void carry_out(compositor::Message message) override;
  compositor::Deadline rest_due() const override;
  void rest() override;

 private:
  struct Part {
    int left = 0;
    int top = 0;
    int right = 0;
    int bottom = 0;
    bool empty() const { return left >= right || top >= bottom; }
  };
  /// What a drawable shows, to the last bit.
  struct Shown {
    Extent2D extent;
    std::vector<std::byte> pixels;
    Part lossy;  ///< what the viewer has of it is a JPEG
  };

  void keep(Shown& shown, const PictureChange& change) const;
  void send_picture(const compositor::Message& message, const PictureChange& change);
  void send_jpeg(const compositor::Message& message, const PictureChange& change);
  void send_refined(const compositor::Message& message, std::uint64_t drawable, Shown& shown);

  int quality_;
  std::map<std::uint64_t, Shown> shown_;
  compositor::Deadline last_picture_{};
  std::vector<std::byte> coded_;
};

}  // namespace understudy::spu
