// SPDX-License-Identifier: Apache-2.0
#include "compositor/rendered.h"
#include "compositor/service.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

std::vector<volume::Image> ImageService::images(std::span<const volume::RenderRequest> requests) {
  std::vector<volume::Image> images;
  images.reserve(requests.size());
  for (const volume::RenderRequest& request : requests) images.push_back(copy_of(render(request).image));
  return images;
}

}  // namespace understudy::compositor
