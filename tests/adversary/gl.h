// SPDX-License-Identifier: Apache-2.0
// The OpenGL functions that the scenarios call, found as a viewer without a loader library finds them.
#pragma once

#include <EGL/egl.h>
#define GL_GLEXT_PROTOTYPES 1
#include <GL/gl.h>
#include <GL/glext.h>

namespace adversary {

// clang-format off
#define ADVERSARY_GL_FUNCTIONS(X) \
  X(ActiveTexture) X(AlphaFunc) X(AttachShader) X(Begin) X(BeginConditionalRender) X(BeginQuery) \
  X(BeginTransformFeedback) X(BindAttribLocation) X(BindBuffer) X(BindBufferBase) X(BindFragDataLocation) \
  X(BindFramebuffer) X(BindImageTexture) X(BindProgramARB) X(BindProgramPipeline) X(BindRenderbuffer) X(BindSampler) \
  X(BindTexture) X(BindVertexArray) X(BlendColor) X(BlendEquation) X(BlendEquationi) X(BlendFunc) X(BlendFunci) X(BlendFuncSeparate) \
  X(BlitFramebuffer) X(BufferData) X(BufferStorage) X(BufferSubData) X(CallList) X(CheckFramebufferStatus) X(ClampColor) X(Clear) \
  X(ClearBufferuiv) X(ClearBufferfv) X(ClearColor) X(ClearStencil) X(ClearTexSubImage) X(ClientActiveTexture) X(ClipPlane) X(Color3f) X(Color4f) X(ColorMask) X(ColorMaski) \
  X(CompileShader) X(CopyImageSubData) X(CopyTexSubImage2D) X(CopyTexSubImage3D) X(CreateProgram) X(CreateShader) \
  X(CreateShaderProgramv) X(CullFace) X(DeleteLists) X(DeleteShader) X(DetachShader) X(DeleteTextures) X(DepthFunc) X(DepthMask) X(Disable) \
  X(DisableVertexAttribArray) X(DispatchCompute) X(DrawArrays) X(DrawArraysInstanced) X(DrawBuffers) \
  X(DrawElements) X(Enable) X(EnableVertexAttribArray) X(End) X(EndConditionalRender) X(EndList) X(EndQuery) \
  X(EndTransformFeedback) X(Finish) X(Fogf) X(Fogfv) X(Fogi) X(FramebufferRenderbuffer) X(FramebufferTexture) \
  X(FramebufferTexture2D) X(FramebufferTextureLayer) X(FrontFace) X(GenBuffers) X(GenFramebuffers) X(GenLists) \
  X(GenProgramPipelines) X(GenProgramsARB) X(GenQueries) X(GenRenderbuffers) X(GenSamplers) X(GenTextures) \
  X(GenVertexArrays) X(GenerateMipmap) X(GetBufferSubData) X(GetError) X(GetIntegerv) X(GetProgramBinary) X(GetProgramInfoLog) X(ProgramBinary) \
  X(GetProgramiv) X(GetQueryObjectuiv) X(GetShaderInfoLog) X(GetShaderiv) X(GetString) X(GetSubroutineIndex) \
  X(GetTexImage) X(GetUniformBlockIndex) X(GetUniformLocation) X(Lightfv) X(LinkProgram) X(LoadMatrixf) X(MapBufferRange) X(Materialfv) X(MatrixMode) \
  X(MemoryBarrier) X(NewList) X(PixelStorei) X(PixelTransferf) X(PointSize) X(PolygonMode) X(ProgramEnvParameter4fARB) X(ProgramLocalParameter4fARB) X(ProgramParameteri) X(ProgramStringARB) \
  X(ProgramUniform1f) X(ProgramUniform1i) X(ProgramUniformMatrix4fv) X(ReadBuffer) X(ReadPixels) \
  X(RenderbufferStorage) X(RenderbufferStorageMultisample) X(SamplerParameteri) X(Scissor) X(ShaderSource) \
  X(StencilFunc) X(StencilOp) X(TexBuffer) X(TexCoord2f) X(TexCoord3f) X(TexCoord3fv) X(TexEnvf) X(TexEnvfv) X(TexEnvi) X(TexGenfv) X(TexGeni) \
  X(TexImage1D) X(TexImage2D) X(TexImage3D) X(TexParameterfv) X(TexParameteri) X(TexStorage3D) X(TexSubImage1D) X(TexSubImage2D) \
  X(TexSubImage3D) X(TransformFeedbackVaryings) X(Uniform1d) X(Uniform1f) X(Uniform1fv) X(Uniform1i) X(Uniform1ui) X(Uniform2f) X(Uniform3f) X(Uniform4f) X(Uniform4fv) \
  X(PolygonOffset) X(ProgramUniform4f) X(UniformMatrix4dv) \
  X(UniformBlockBinding) X(UniformMatrix2x3fv) X(UniformMatrix4fv) X(UniformSubroutinesuiv) X(UnmapBuffer) X(UseProgram) \
  X(UseProgramStages) X(Vertex2f) X(Vertex3f) X(Vertex3fv) X(VertexAttrib1f) X(VertexAttribPointer) X(VertexPointer) X(TexCoordPointer) X(EnableClientState) X(DisableClientState) X(Viewport)
// clang-format on

struct Gl {
#define ADVERSARY_GL_MEMBER(name) decltype(&::gl##name) name;  // NOLINT(bugprone-macro-parentheses): a name
  ADVERSARY_GL_FUNCTIONS(ADVERSARY_GL_MEMBER)
#undef ADVERSARY_GL_MEMBER
};

/// A context must be current. Functions that the driver lacks are null.
Gl load_gl();

}  // namespace adversary
