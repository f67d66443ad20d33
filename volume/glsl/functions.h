// SPDX-License-Identifier: Apache-2.0
// The OpenGL functions that the GLSL ray caster uses: 3.3 core, each entry point from the library of its
// context.
#pragma once

#include <GL/glcorearb.h>

namespace understudy::volume::glsl {

// name, and its type in the Khronos header
#define UNDERSTUDY_GLSL_FUNCTIONS(each)                                                                        \
  each(ActiveTexture, PFNGLACTIVETEXTUREPROC) each(AttachShader, PFNGLATTACHSHADERPROC) each(                  \
      BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC) each(BindTexture, PFNGLBINDTEXTUREPROC)                       \
      each(BindVertexArray, PFNGLBINDVERTEXARRAYPROC) each(                                                    \
          CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC) each(CompileShader, PFNGLCOMPILESHADERPROC) \
          each(CreateProgram, PFNGLCREATEPROGRAMPROC) each(CreateShader, PFNGLCREATESHADERPROC) each(          \
              DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC) each(DeleteProgram, PFNGLDELETEPROGRAMPROC)     \
              each(DeleteShader, PFNGLDELETESHADERPROC) each(DeleteTextures, PFNGLDELETETEXTURESPROC) each(    \
                  DrawArrays, PFNGLDRAWARRAYSPROC) each(DrawBuffers, PFNGLDRAWBUFFERSPROC)                     \
                  each(FramebufferTexture, PFNGLFRAMEBUFFERTEXTUREPROC) each(                                  \
                      GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC) each(GenTextures, PFNGLGENTEXTURESPROC)       \
                      each(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC) each(GetError, PFNGLGETERRORPROC) each(  \
                          GetIntegerv, PFNGLGETINTEGERVPROC) each(GetProgramInfoLog,                           \
                                                                  PFNGLGETPROGRAMINFOLOGPROC)                  \
                          each(GetProgramiv, PFNGLGETPROGRAMIVPROC) each(GetString, PFNGLGETSTRINGPROC) each(  \
                              GetStringi, PFNGLGETSTRINGIPROC)                                                 \
                              each(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC) each(                      \
                                  LinkProgram, PFNGLLINKPROGRAMPROC) each(PixelStorei, PFNGLPIXELSTOREIPROC)   \
                                  each(ReadBuffer, PFNGLREADBUFFERPROC) each(ReadPixels, PFNGLREADPIXELSPROC)  \
                                      each(ShaderSource, PFNGLSHADERSOURCEPROC)                                \
                                          each(TexImage1D, PFNGLTEXIMAGE1DPROC) each(TexImage2D,               \
                                                                                     PFNGLTEXIMAGE2DPROC)      \
                                              each(TexImage3D, PFNGLTEXIMAGE3DPROC) each(                      \
                                                  TexParameteri, PFNGLTEXPARAMETERIPROC)                       \
                                                  each(TexSubImage2D, PFNGLTEXSUBIMAGE2DPROC) each(            \
                                                      TexSubImage3D, PFNGLTEXSUBIMAGE3DPROC)                   \
                                                      each(Uniform1f, PFNGLUNIFORM1FPROC) each(                \
                                                          Uniform1i, PFNGLUNIFORM1IPROC)                       \
                                                          each(Uniform3fv, PFNGLUNIFORM3FVPROC) each(          \
                                                              Uniform3iv, PFNGLUNIFORM3IVPROC)                 \
                                                              each(Uniform4fv, PFNGLUNIFORM4FVPROC) each(      \
                                                                  UniformMatrix4fv, PFNGLUNIFORMMATRIX4FVPROC) \
                                                                  each(UseProgram, PFNGLUSEPROGRAMPROC)        \
                                                                      each(Viewport, PFNGLVIEWPORTPROC)

struct Functions {
#define UNDERSTUDY_GLSL_MEMBER(name, type) type name = nullptr;
  UNDERSTUDY_GLSL_FUNCTIONS(UNDERSTUDY_GLSL_MEMBER)
#undef UNDERSTUDY_GLSL_MEMBER
};

}  // namespace understudy::volume::glsl
