// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote/x_shared_memory.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>
#include <xcb/shm.h>

#include "interceptor/library_function.h"
#include "interceptor/real_driver.h"

namespace understudy::interceptor {
namespace {

struct Functions {
  decltype(&xcb_get_file_descriptor) get_file_descriptor;
  decltype(&xcb_get_extension_data) get_extension_data;
  decltype(&xcb_generate_id) generate_id;
  decltype(&xcb_request_check) request_check;
  xcb_extension_t* extension;
  decltype(&xcb_shm_query_version) query_version;
  decltype(&xcb_shm_query_version_reply) query_version_reply;
  decltype(&xcb_shm_attach_fd_checked) attach;
  decltype(&xcb_shm_detach) detach;
  decltype(&xcb_shm_put_image) put_image;
};

constinit Functions functions{};
constinit int state = 0;  ///< 1: available, -1: not

/// Logs nothing if the library is missing: images then go through the socket.
bool open_functions() {
  void* xcb = real_dlopen("libxcb.so.1", RTLD_NOW | RTLD_LOCAL);
  void* shm = real_dlopen("libxcb-shm.so.0", RTLD_NOW | RTLD_LOCAL);
  Functions& f = functions;
  return xcb != nullptr && shm != nullptr &&
         find_in_library(xcb, "xcb_get_file_descriptor", f.get_file_descriptor) &&
         find_in_library(xcb, "xcb_get_extension_data", f.get_extension_data) &&
         find_in_library(xcb, "xcb_generate_id", f.generate_id) &&
         find_in_library(xcb, "xcb_request_check", f.request_check) &&
         find_in_library(shm, "xcb_shm_id", f.extension) &&
         find_in_library(shm, "xcb_shm_query_version", f.query_version) &&
         find_in_library(shm, "xcb_shm_query_version_reply", f.query_version_reply) &&
         find_in_library(shm, "xcb_shm_attach_fd_checked", f.attach) &&
         find_in_library(shm, "xcb_shm_detach", f.detach) &&
         find_in_library(shm, "xcb_shm_put_image", f.put_image);
}

/// Checks first, because a request with a descriptor ends a connection that cannot carry one, and so does a
/// request that the server does not support.
bool takes_descriptors(xcb_connection_t* connection) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  const int socket = functions.get_file_descriptor(connection);
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&address), &length) != 0 || address.ss_family != AF_UNIX)
    return false;
  const xcb_query_extension_reply_t* known = functions.get_extension_data(connection, functions.extension);
  if (known == nullptr || known->present == 0) return false;
  xcb_shm_query_version_reply_t* version =
      functions.query_version_reply(connection, functions.query_version(connection), nullptr);
  if (version == nullptr) return false;
  const bool enough =
      version->major_version > 1 || (version->major_version == 1 && version->minor_version >= 2);
  free(version);
  return enough;
}

void release(XSharedMemory* memory, xcb_connection_t* connection) {
  if (memory->bytes == nullptr) return;
  functions.detach(connection, memory->segment);
  munmap(memory->bytes, memory->size);
  memory->bytes = nullptr;
  memory->size = 0;
}

bool attach(XSharedMemory* memory, xcb_connection_t* connection, std::size_t size) {
  const int descriptor = memfd_create("understudy-image", MFD_CLOEXEC);
  if (descriptor < 0) return false;
  void* bytes = MAP_FAILED;
  if (ftruncate(descriptor, static_cast<off_t>(size)) == 0)
    bytes = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (bytes == MAP_FAILED) {
    close(descriptor);
    return false;
  }
  const std::uint32_t segment = functions.generate_id(connection);
  // The descriptor is closed when it has been sent.
  xcb_generic_error_t* error =
      functions.request_check(connection, functions.attach(connection, segment, descriptor, 1));
  if (error != nullptr) {
    free(error);
    munmap(bytes, size);
    return false;
  }
  *memory = {segment, static_cast<std::uint8_t*>(bytes), size, false};
  return true;
}

bool make_room(XSharedMemory* memory, xcb_connection_t* connection, std::size_t size) {
  if (memory->refused) return false;
  if (memory->size >= size) return true;
  if (state == 0) state = open_functions() ? 1 : -1;
  memory->refused = state < 0 || (memory->bytes == nullptr && !takes_descriptors(connection));
  if (memory->refused) return false;
  release(memory, connection);
  // Windows grow by a few pixels at a time, so half as much again is reserved.
  return attach(memory, connection, size + size / 2);
}

}  // namespace

bool put_shared_image(XSharedMemory* memory, xcb_connection_t* connection, xcb_drawable_t drawable,
                      xcb_gcontext_t gc, std::uint8_t depth, const RemoteImage& image) {
  const std::size_t size = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4;
  if (!make_room(memory, connection, size)) return false;
  memcpy(memory->bytes, image.pixels, size);
  const auto width = static_cast<std::uint16_t>(image.width);
  const auto height = static_cast<std::uint16_t>(image.height);
  functions.put_image(connection, drawable, gc, width, height, 0, 0, width, height, 0, 0, depth,
                      XCB_IMAGE_FORMAT_Z_PIXMAP, 0, memory->segment, 0);
  return true;
}

}  // namespace understudy::interceptor
