# SPDX-License-Identifier: Apache-2.0
"""OpenGL from Python with ctypes only: opens the libraries by the names that programs use, draws and reads back.

    draws.py GL [EGL]      "libGL.so.1", "find" (ctypes.util.find_library), or an absolute path
"""

import ctypes
import ctypes.util
import sys


def open_library(asked, short):
    return ctypes.CDLL(ctypes.util.find_library(short) if asked == "find" else asked)


gl = open_library(sys.argv[1], "GL")
egl = open_library(sys.argv[2] if len(sys.argv) > 2 else "libEGL.so.1", "EGL")

void = ctypes.c_void_p
for name in ("eglGetPlatformDisplay", "eglCreateContext", "eglCreatePbufferSurface", "eglGetProcAddress"):
    getattr(egl, name).restype = void
egl.eglGetPlatformDisplay.argtypes = (ctypes.c_uint, void, void)
egl.eglInitialize.argtypes = (void, void, void)
egl.eglChooseConfig.argtypes = (void, void, void, ctypes.c_int, void)
egl.eglCreateContext.argtypes = (void, void, void, void)
egl.eglCreatePbufferSurface.argtypes = (void, void, void)
egl.eglMakeCurrent.argtypes = (void, void, void, void)
egl.eglSwapBuffers.argtypes = (void, void)
gl.glClearColor.argtypes = (ctypes.c_float,) * 4

PLATFORM_SURFACELESS, OPENGL_API = 0x31DD, 0x30A2
display = egl.eglGetPlatformDisplay(PLATFORM_SURFACELESS, None, None)
assert egl.eglInitialize(display, None, None)
assert egl.eglBindAPI(OPENGL_API)
wanted = (ctypes.c_int * 7)(0x3033, 1, 0x3040, 8, 0x3021, 8, 0x3038)  # surface pbuffer, OpenGL, alpha 8
config, count = void(), ctypes.c_int()
assert egl.eglChooseConfig(display, wanted, ctypes.byref(config), 1, ctypes.byref(count)) and count.value
context = egl.eglCreateContext(display, config, None, None)
surface = egl.eglCreatePbufferSurface(display, config, (ctypes.c_int * 5)(0x3057, 16, 0x3056, 16, 0x3038))
assert egl.eglMakeCurrent(display, surface, surface, context)

clear = ctypes.CFUNCTYPE(None, ctypes.c_uint)(egl.eglGetProcAddress(b"glClear"))
gl.glClearColor(0.25, 0.5, 0.75, 1.0)
clear(0x4000)
pixel = (ctypes.c_ubyte * 4)()
gl.glReadPixels(3, 3, 1, 1, 0x1908, 0x1401, pixel)
egl.eglSwapBuffers(display, surface)
print(*pixel, hex(gl.glGetError()))
