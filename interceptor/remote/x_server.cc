// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote/x_server.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xcb/xcb.h>

#include "interceptor/library_function.h"
#include "interceptor/log_line.h"
#include "interceptor/real_driver.h"
#include "interceptor/remote/x_shared_memory.h"

namespace understudy::interceptor {
namespace {

struct Xcb {
  decltype(&xcb_connect) connect;
  decltype(&xcb_connection_has_error) has_error;
  decltype(&xcb_generate_id) generate_id;
  decltype(&xcb_create_gc) create_gc;
  decltype(&xcb_free_gc) free_gc;
  decltype(&xcb_put_image) put_image;
  decltype(&xcb_get_geometry) get_geometry;
  decltype(&xcb_get_geometry_reply) get_geometry_reply;
  decltype(&xcb_get_input_focus) get_input_focus;
  decltype(&xcb_get_input_focus_reply) get_input_focus_reply;
  decltype(&xcb_poll_for_event) poll_for_event;
  decltype(&xcb_get_maximum_request_length) get_maximum_request_length;
};

/// An application's display, and our connection to the same server.
struct Server {
  Display* display;
  xcb_connection_t* connection;  ///< null: it could not be made
  XSharedMemory memory;          ///< for images
  Server* next;
};

constinit pthread_mutex_t x_lock = PTHREAD_MUTEX_INITIALIZER;
constinit Server* servers = nullptr;
constinit Xlib xlib_functions{};
constinit Xcb xcb_functions{};
constinit int xlib_state = 0;  ///< 1: available, -1: not
constinit int xcb_state = 0;

class Locked {
 public:
  Locked() { pthread_mutex_lock(&x_lock); }
  ~Locked() { pthread_mutex_unlock(&x_lock); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;
};

void* open_library(const char* name) {
  void* library = real_dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    log_line(logging::Level::error, "%s cannot be opened, so no window can be drawn into: %s", name, dlerror());
  return library;
}

bool open_xlib() {
  void* library = open_library("libX11.so.6");
  return library != nullptr && find_in_library(library, "XGetVisualInfo", xlib_functions.get_visual_info) &&
         find_in_library(library, "XFree", xlib_functions.free) &&
         find_in_library(library, "XOpenDisplay", xlib_functions.open_display) &&
         find_in_library(library, "XSync", xlib_functions.sync) &&
         find_in_library(library, "XFlush", xlib_functions.flush);
}

bool open_xcb() {
  void* library = open_library("libxcb.so.1");
  Xcb& xcb = xcb_functions;
  return library != nullptr && find_in_library(library, "xcb_connect", xcb.connect) &&
         find_in_library(library, "xcb_connection_has_error", xcb.has_error) &&
         find_in_library(library, "xcb_generate_id", xcb.generate_id) &&
         find_in_library(library, "xcb_create_gc", xcb.create_gc) &&
         find_in_library(library, "xcb_free_gc", xcb.free_gc) &&
         find_in_library(library, "xcb_put_image", xcb.put_image) &&
         find_in_library(library, "xcb_get_geometry", xcb.get_geometry) &&
         find_in_library(library, "xcb_get_geometry_reply", xcb.get_geometry_reply) &&
         find_in_library(library, "xcb_get_input_focus", xcb.get_input_focus) &&
         find_in_library(library, "xcb_get_input_focus_reply", xcb.get_input_focus_reply) &&
         find_in_library(library, "xcb_poll_for_event", xcb.poll_for_event) &&
         find_in_library(library, "xcb_get_maximum_request_length", xcb.get_maximum_request_length);
}

/// Requires the lock. Returns null without a connection.
Server* server_of(Display* display) {
  for (Server* server = servers; server != nullptr; server = server->next) {
    if (server->display == display) return server->connection == nullptr ? nullptr : server;
  }
  if (xcb_state == 0) xcb_state = open_xcb() ? 1 : -1;
  if (xcb_state < 0) return nullptr;
  auto* server = static_cast<Server*>(malloc(sizeof(Server)));
  if (server == nullptr) return nullptr;
  xcb_connection_t* connection = xcb_functions.connect(DisplayString(display), nullptr);
  if (xcb_functions.has_error(connection) != 0) {
    log_line(logging::Level::error, "the X server at %s takes no second connection; nothing is shown",
             DisplayString(display));
    connection = nullptr;
  }
  *server = {display, connection, {}, servers};
  servers = server;
  return connection == nullptr ? nullptr : server;
}

struct Geometry {
  int width;
  int height;
  int depth;
};

bool geometry_of(xcb_connection_t* connection, XID drawable, Geometry* geometry) {
  xcb_generic_error_t* error = nullptr;
  xcb_get_geometry_reply_t* reply = xcb_functions.get_geometry_reply(
      connection, xcb_functions.get_geometry(connection, static_cast<xcb_drawable_t>(drawable)), &error);
  free(error);
  if (reply == nullptr) return false;
  *geometry = {reply->width, reply->height, reply->depth};
  free(reply);
  return true;
}

/// Discards events, which are errors of windows that no longer exist.
void forget_events(xcb_connection_t* connection) {
  while (xcb_generic_event_t* event = xcb_functions.poll_for_event(connection)) free(event);
}

/// Sends the image through the socket, in as many parts as the maximum request length requires.
void send_image(xcb_connection_t* connection, xcb_drawable_t drawable, xcb_gcontext_t gc, std::uint8_t depth,
                const RemoteImage& image) {
  const int row_bytes = image.width * 4;
  const auto room = static_cast<long>(xcb_functions.get_maximum_request_length(connection)) * 4 - 64;
  const int rows_at_once = room < row_bytes ? 1 : static_cast<int>(room / row_bytes);
  for (int y = 0; y < image.height; y += rows_at_once) {
    const int rows = image.height - y < rows_at_once ? image.height - y : rows_at_once;
    xcb_functions.put_image(
        connection, XCB_IMAGE_FORMAT_Z_PIXMAP, drawable, gc, static_cast<std::uint16_t>(image.width),
        static_cast<std::uint16_t>(rows), 0, static_cast<std::int16_t>(y), 0, depth,
        static_cast<std::uint32_t>(rows * row_bytes), image.pixels + static_cast<long>(y) * row_bytes);
  }
}

}  // namespace

const Xlib* xlib() {
  const Locked locked;
  if (xlib_state == 0) xlib_state = open_xlib() ? 1 : -1;
  return xlib_state > 0 ? &xlib_functions : nullptr;
}

Display* default_display() {
  static constinit Display* opened = nullptr;
  const Xlib* x = xlib();
  if (x == nullptr) return nullptr;
  const Locked locked;
  if (opened == nullptr) opened = x->open_display(nullptr);
  return opened;
}

XID new_id(Display* display) {
  const Locked locked;
  const Server* server = server_of(display);
  return server != nullptr ? xcb_functions.generate_id(server->connection) : None;
}

bool extent_of(Display* display, XID drawable, int* width, int* height) {
  const Locked locked;
  const Server* server = server_of(display);
  Geometry geometry{};
  if (server == nullptr || !geometry_of(server->connection, drawable, &geometry)) return false;
  *width = geometry.width;
  *height = geometry.height;
  return true;
}

void put_image(Display* display, XID drawable, const RemoteImage& image) {
  const Locked locked;
  Server* server = server_of(display);
  if (server == nullptr || image.width <= 0 || image.height <= 0) return;
  xcb_connection_t* connection = server->connection;
  Geometry geometry{};
  if (!geometry_of(connection, drawable, &geometry)) return;
  const auto target = static_cast<xcb_drawable_t>(drawable);
  const auto depth = static_cast<std::uint8_t>(geometry.depth);
  const xcb_gcontext_t gc = xcb_functions.generate_id(connection);
  xcb_functions.create_gc(connection, gc, target, 0, nullptr);
  if (!put_shared_image(&server->memory, connection, target, gc, depth, image))
    send_image(connection, target, gc, depth, image);
  xcb_functions.free_gc(connection, gc);
  free(xcb_functions.get_input_focus_reply(connection, xcb_functions.get_input_focus(connection), nullptr));
  forget_events(connection);
}

}  // namespace understudy::interceptor
