// SPDX-License-Identifier: Apache-2.0
// A stub library: nothing but an OpenGL SONAME. All its functions come from its dependency, libunderstudy.so.
