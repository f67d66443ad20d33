// SPDX-License-Identifier: Apache-2.0
// Program binaries: those of another run are refused; those of this run keep their sources.
#include <gtest/gtest.h>

#include <vector>

#include "gl_application.h"
#include "glsl_program.h"
#include "spu/track/share_group.h"

namespace understudy::spu::testing {
namespace {

constexpr const char* vertex = "#version 130\nin vec4 corner;\nvoid main() { gl_Position = corner; }";
constexpr const char* fragment = "#version 130\nout vec4 colour;\nvoid main() { colour = vec4(0.5); }";

struct Binary {
  GLenum format = 0;
  std::vector<char> bytes;
};

Binary binary_of(const DispatchTable& gl, GLuint program) {
  GLint length = 0;
  gl.GetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &length);
  Binary binary;
  binary.bytes.resize(std::size_t(length));
  gl.GetProgramBinary(program, length, nullptr, &binary.format, binary.bytes.data());
  return binary;
}

bool loads(const DispatchTable& gl, GLuint program, const Binary& binary) {
  gl.ProgramBinary(program, binary.format, binary.bytes.data(), GLsizei(binary.bytes.size()));
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  return linked != 0;
}

class ProgramBinaries : public ::testing::Test {
 protected:
  void SetUp() override {
    application_ = GlApplication::start(Profile::compatibility);
    ASSERT_TRUE(application_) << "no EGL context here";
    GLint formats = 0;
    gl().GetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
    ASSERT_GT(formats, 0);
    program_ = glsl_program(gl(), vertex, fragment);
  }
  void TearDown() override {
    for (const GLuint program : programs_) gl().DeleteProgram(program);
  }
  const DispatchTable& gl() const { return application_->gl(); }
  /// Is deleted after the test.
  GLuint new_program() { return programs_.emplace_back(gl().CreateProgram()); }

  std::unique_ptr<GlApplication> application_;
  GLuint program_ = 0;
  std::vector<GLuint> programs_;
};

TEST_F(ProgramBinaries, OfThisRunAreLoaded) {
  const Binary binary = binary_of(gl(), program_);
  EXPECT_TRUE(loads(gl(), new_program(), binary));
  EXPECT_EQ(application_->error(), GLenum(GL_NO_ERROR));
}

TEST_F(ProgramBinaries, OfAnotherRunAreRefusedAndSourcesCompiledInstead) {
  const Binary binary = binary_of(application_->driver(), program_);
  const GLuint other = new_program();
  EXPECT_FALSE(loads(gl(), other, binary));
  EXPECT_EQ(application_->error(), GLenum(GL_NO_ERROR));
  EXPECT_TRUE(loads(application_->driver(), other, binary));  // the driver would have accepted it
  glsl_program(gl(), vertex, fragment);
}

TEST_F(ProgramBinaries, OfAnotherRunAreRefusedOnceThereIsAVolume) {
  const std::vector<GLubyte> texels(8 * 8 * 8);
  gl().BindTexture(GL_TEXTURE_3D, 1);
  gl().TexImage3D(GL_TEXTURE_3D, 0, GL_R8, 8, 8, 8, 0, GL_RED, GL_UNSIGNED_BYTE, texels.data());
  const Binary binary = binary_of(application_->driver(), program_);
  EXPECT_FALSE(loads(gl(), new_program(), binary));
  EXPECT_EQ(application_->error(), GLenum(GL_NO_ERROR));
}

TEST_F(ProgramBinaries, SayTheirLengthOnlyWhereTheDriverDoes) {
  GLsizei length = 77;
  GLenum format = 0;
  char none = 0;
  gl().GetProgramBinary(0, 1, &length, &format, &none);  // not a program
  GLsizei of_driver = 77;
  application_->driver().GetProgramBinary(0, 1, &of_driver, &format, &none);
  EXPECT_EQ(length, of_driver);
}

}  // namespace
}  // namespace understudy::spu::testing
