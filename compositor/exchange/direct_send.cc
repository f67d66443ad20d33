#include "compositor/exchange/direct_send.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "compositor/blend.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {

namespace {

using volume::Image;
using volume::Rect;

// The k-th of `count` strips of `whole`, cut across its longer side so that none is empty before it must be.
Rect strip(const Rect& whole, std::size_t k, std::size_t count) {
  const auto cut = [&](int length, std::size_t at) {
    return int(std::uint64_t(length) * std::uint64_t(at) / std::uint64_t(count));
  };
  Rect result = whole;
  if (whole.height >= whole.width) {
    result.y += cut(whole.height, k);
    result.height = cut(whole.height, k + 1) - cut(whole.height, k);
  } else {
    result.x += cut(whole.width, k);
    result.width = cut(whole.width, k + 1) - cut(whole.width, k);
  }
  return result;
}

void copy_part(const Image& from, Image& to) {
  const Rect part = intersection(from.rect, to.rect);
  for (int y = part.y; y < part.y + part.height; ++y)
    std::memcpy(to.at(part.x, y), from.at(part.x, y), 4 * sizeof(float) * std::size_t(part.width));
}

std::span<const std::byte> bytes(const Image& image) {
  return std::as_bytes(std::span(image.rgba));
}
std::span<std::byte> writable_bytes(Image& image) {
  return std::as_writable_bytes(std::span(image.rgba));
}

// Who owns which strip, and which part of it anybody touches at all: known to every rank alike.
struct Plan {
  std::vector<Rank> owners;
  std::vector<Rect> strips;    ///< by owner
  std::vector<Rect> finished;  ///< the part of each strip that footprints touch
  Rect whole;

  explicit Plan(std::span<const Rect> footprints) {
    for (std::size_t rank = 0; rank < footprints.size(); ++rank) {
      if (footprints[rank].empty()) continue;
      owners.push_back(Rank(rank));
      whole = bounding(whole, footprints[rank]);
    }
    for (std::size_t k = 0; k < owners.size(); ++k) {
      strips.push_back(strip(whole, k, owners.size()));
      Rect touched;
      for (const Rect& footprint : footprints) touched = bounding(touched, intersection(footprint, strips[k]));
      finished.push_back(touched);
    }
  }

  // Of the parts that change hands on the way to the strips' owners, and of the strips on their way to rank 0.
  std::uint64_t bytes(std::span<const Rect> footprints) const {
    std::uint64_t pixels = 0;
    for (std::size_t k = 0; k < owners.size(); ++k) {
      for (const Rank rank : owners)
        if (rank != owners[k]) pixels += intersection(footprints[std::size_t(rank)], strips[k]).pixels();
      if (owners[k] != 0) pixels += finished[k].pixels();
    }
    return pixels * 4 * sizeof(float);
  }
};

// Sends the parts of `mine` that lie in other owners' strips, receives what lies in this rank's, and blends
// that.
Image exchange_strips(const Plan& plan, const Image& mine, const Composition& composition, Link& link) {
  const std::size_t me = std::size_t(std::ranges::find(plan.owners, link.rank()) - plan.owners.begin());
  std::vector<Image> outgoing_parts(plan.owners.size());
  std::vector<Image> parts(composition.footprints.size());  // by rank; this rank's own stays in `mine`
  std::vector<Outgoing> outgoing;
  std::vector<Incoming> incoming;
  for (std::size_t k = 0; k < plan.owners.size(); ++k) {
    if (k == me) continue;
    const Rank other = plan.owners[k];
    if (const Rect part = intersection(mine.rect, plan.strips[k]); !part.empty()) {
      outgoing_parts[k] = Image(part);
      copy_part(mine, outgoing_parts[k]);
      outgoing.push_back({other, bytes(outgoing_parts[k])});
    }
    if (const Rect part = intersection(composition.footprints[std::size_t(other)], plan.strips[me]);
        !part.empty()) {
      parts[std::size_t(other)] = Image(part);
      incoming.push_back({other, writable_bytes(parts[std::size_t(other)])});
    }
  }
  link.transfer(outgoing, incoming);

  Image result(plan.finished[me]);
  std::ranges::fill(result.rgba, volume::neutral_value(composition.op));
  for (const Rank rank : composition.order)
    blend(composition.op, result, rank == link.rank() ? mine.view() : parts[std::size_t(rank)].view());
  return result;
}

// The finished strips of all owners, put together on rank 0.
Image gather(const Plan& plan, Image finished, volume::Operator op, Link& link) {
  if (link.rank() != 0) {
    if (finished.rect.empty()) return {};
    const Outgoing message{0, bytes(finished)};
    link.transfer({&message, 1}, {});
    return {};
  }
  if (plan.owners.size() == 1 && plan.owners.front() == 0) return finished;

  std::vector<Image> strips(plan.owners.size());
  std::vector<Incoming> incoming;
  for (std::size_t k = 0; k < plan.owners.size(); ++k) {
    if (plan.owners[k] == 0) {
      strips[k] = std::move(finished);
    } else if (!plan.finished[k].empty()) {
      strips[k] = Image(plan.finished[k]);
      incoming.push_back({plan.owners[k], writable_bytes(strips[k])});
    }
  }
  link.transfer({}, incoming);
  if (strips.size() == 1) return std::move(strips.front());

  Image picture(plan.whole);
  if (const float value = volume::neutral_value(op); value != 0) std::ranges::fill(picture.rgba, value);
  for (const Image& part : strips) copy_part(part, picture);
  return picture;
}

}  // namespace

Exchanged direct_send(Image mine, const Composition& composition, Link& link) {
  Exchanged result;
  const Plan plan(composition.footprints);
  result.bytes = plan.bytes(composition.footprints);
  const bool takes_part = !mine.rect.empty();
  if (plan.owners.empty() || (!takes_part && link.rank() != 0)) return result;
  // One image is a finished picture already.
  Image finished = plan.owners.size() == 1 ? std::move(mine)
                   : takes_part            ? exchange_strips(plan, mine, composition, link)
                                           : Image();
  result.picture = gather(plan, std::move(finished), composition.op, link);
  return result;
}

}  // namespace understudy::compositor
