// SPDX-License-Identifier: Apache-2.0
#include "interceptor/x_font.h"

#include <X11/Xutil.h>
#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <initializer_list>

#include "interceptor/library_function.h"
#include "interceptor/real_driver.h"

namespace understudy::interceptor {
namespace {

struct Functions {
  decltype(&XQueryFont) query_font;
  decltype(&XFreeFontInfo) free_font_info;
  decltype(&XCreatePixmap) create_pixmap;
  decltype(&XFreePixmap) free_pixmap;
  decltype(&XCreateGC) create_gc;
  decltype(&XFreeGC) free_gc;
  decltype(&XSetForeground) set_foreground;
  decltype(&XFillRectangle) fill_rectangle;
  decltype(&XDrawString16) draw_string;
  decltype(&XGetImage) get_image;
};

constinit Functions x{};
constinit bool is_open = false;

void open_functions() {
  // Xlib has already been opened, since there is a display.
  void* library = real_dlopen("libX11.so.6", RTLD_NOW | RTLD_LOCAL);
  is_open = library != nullptr && find_in_library(library, "XQueryFont", x.query_font) &&
            find_in_library(library, "XFreeFontInfo", x.free_font_info) &&
            find_in_library(library, "XCreatePixmap", x.create_pixmap) &&
            find_in_library(library, "XFreePixmap", x.free_pixmap) &&
            find_in_library(library, "XCreateGC", x.create_gc) &&
            find_in_library(library, "XFreeGC", x.free_gc) &&
            find_in_library(library, "XSetForeground", x.set_foreground) &&
            find_in_library(library, "XFillRectangle", x.fill_rectangle) &&
            find_in_library(library, "XDrawString16", x.draw_string) &&
            find_in_library(library, "XGetImage", x.get_image);
}

/// Null if the font lacks the character.
const XCharStruct* metrics_of(const XFontStruct& font, unsigned character) {
  // A font with a single row is indexed by 16 bits, others by two bytes.
  const bool one_row = font.min_byte1 == 0 && font.max_byte1 == 0;
  const unsigned row = one_row ? 0 : character >> 8;
  const unsigned column = one_row ? character : character & 0xff;
  if (row < font.min_byte1 || row > font.max_byte1 || column < font.min_char_or_byte2 ||
      column > font.max_char_or_byte2) {
    return nullptr;
  }
  if (font.per_char == nullptr) return &font.min_bounds;
  const unsigned columns = font.max_char_or_byte2 - font.min_char_or_byte2 + 1;
  const XCharStruct& glyph = font.per_char[(row - font.min_byte1) * columns + column - font.min_char_or_byte2];
  // Xlib marks a missing character within the bounds by all-zero metrics.
  const bool missing =
      glyph.width == 0 && glyph.lbearing == 0 && glyph.rbearing == 0 && glyph.ascent == 0 && glyph.descent == 0;
  return missing ? nullptr : &glyph;
}

/// A bitmap of one bit per pixel, as large as the font's largest glyph, that the server draws into.
class GlyphPixmap {
 public:
  GlyphPixmap(Display* display, Font font, int width, int height)
      : display_(display), width_(width > 0 ? width : 1), height_(height > 0 ? height : 1) {
    // Not created for the current drawable, which the server may not know.
    pixmap_ = x.create_pixmap(display, DefaultRootWindow(display), static_cast<unsigned>(width_),
                              static_cast<unsigned>(height_), 1);
    XGCValues values{};
    values.font = font;
    values.graphics_exposures = False;
    gc_ = x.create_gc(display, pixmap_, GCFont | GCGraphicsExposures, &values);
  }
  ~GlyphPixmap() {
    x.free_gc(display_, gc_);
    x.free_pixmap(display_, pixmap_);
  }
  GlyphPixmap(const GlyphPixmap&) = delete;
  GlyphPixmap& operator=(const GlyphPixmap&) = delete;

  /// Writes `bits` in glBitmap's layout: rows of whole bytes from the bottom, first pixel in the highest bit.
  void draw(unsigned character, const XCharStruct& glyph, int width, int height, unsigned char* bits) const {
    const int row_bytes = (width + 7) / 8;
    memset(bits, 0, static_cast<size_t>(row_bytes) * static_cast<size_t>(height));
    x.set_foreground(display_, gc_, 0);
    x.fill_rectangle(display_, pixmap_, gc_, 0, 0, static_cast<unsigned>(width_),
                     static_cast<unsigned>(height_));
    x.set_foreground(display_, gc_, 1);
    const XChar2b name = {static_cast<unsigned char>(character >> 8 & 0xff),
                          static_cast<unsigned char>(character & 0xff)};
    x.draw_string(display_, pixmap_, gc_, -glyph.lbearing, glyph.ascent, &name, 1);
    XImage* image = x.get_image(display_, pixmap_, 0, 0, static_cast<unsigned>(width),
                                static_cast<unsigned>(height), 1, XYPixmap);
    if (image == nullptr) return;
    for (int y = 0; y < height; ++y) {
      unsigned char* row = bits + static_cast<ptrdiff_t>(height - 1 - y) * row_bytes;
      for (int column = 0; column < width; ++column)
        if (XGetPixel(image, column, y) != 0) row[column / 8] |= static_cast<unsigned char>(0x80 >> column % 8);
    }
    XDestroyImage(image);
  }

 private:
  Display* display_;
  int width_;
  int height_;
  Pixmap pixmap_;
  GC gc_;
};

/// While in scope, glBitmap reads tightly packed rows from the application's memory.
class TightBitmaps {
 public:
  explicit TightBitmaps(const spu::DispatchTable& gl) : gl_(gl) {
    gl.GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &buffer_);
    if (buffer_ != 0) gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl.PushClientAttrib(GL_CLIENT_PIXEL_STORE_BIT);
    for (const GLenum name : {GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST, GL_UNPACK_ROW_LENGTH,
                              GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS}) {
      gl.PixelStorei(name, 0);
    }
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  }
  ~TightBitmaps() {
    gl_.PopClientAttrib();
    if (buffer_ != 0) gl_.BindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(buffer_));
  }
  TightBitmaps(const TightBitmaps&) = delete;
  TightBitmaps& operator=(const TightBitmaps&) = delete;

 private:
  const spu::DispatchTable& gl_;
  GLint buffer_ = 0;
};

void make_lists(const spu::DispatchTable& gl, Display* display, const XFontStruct& font, Font name, int first,
                int count, int list) {
  const int width = font.max_bounds.rbearing - font.min_bounds.lbearing;
  const int height = font.max_bounds.ascent + font.max_bounds.descent;
  const int room = width > 0 && height > 0 ? (width + 7) / 8 * height : 1;
  auto* bits = static_cast<unsigned char*>(malloc(static_cast<size_t>(room)));
  if (bits == nullptr) return;
  {
    const GlyphPixmap pixmap(display, name, width, height);
    const TightBitmaps tight(gl);
    for (int i = 0; i < count; ++i) {
      const auto character = static_cast<unsigned>(first + i);
      gl.NewList(static_cast<GLuint>(list + i), GL_COMPILE);
      if (const XCharStruct* glyph = metrics_of(font, character)) {
        const int columns = glyph->rbearing - glyph->lbearing;
        const int rows = glyph->ascent + glyph->descent;
        // The bounds come from the font file and may be wrong.
        const bool fits = columns > 0 && rows > 0 && columns <= width && rows <= height;
        if (fits) pixmap.draw(character, *glyph, columns, rows, bits);
        // The origin is where drivers place it, one row above the baseline of X.
        // Not a null pointer: Mesa reports it as out of memory, although nothing would be read.
        gl.Bitmap(fits ? columns : 0, fits ? rows : 0, static_cast<GLfloat>(-glyph->lbearing),
                  static_cast<GLfloat>(glyph->descent - 1), static_cast<GLfloat>(glyph->width), 0, bits);
      }
      gl.EndList();
    }
  }
  free(bits);
}

}  // namespace

void make_lists_of_font(const spu::DispatchTable& gl, Display* display, Font font, int first, int count,
                        int list) {
  static constinit pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, &open_functions);
  if (!is_open || first < 0 || count < 0) return;
  XFontStruct* metrics = x.query_font(display, font);
  if (metrics == nullptr) return;
  make_lists(gl, display, *metrics, font, first, count, list);
  x.free_font_info(nullptr, metrics, 1);
}

}  // namespace understudy::interceptor
