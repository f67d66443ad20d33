// SPDX-License-Identifier: Apache-2.0
// A stub library: an OpenGL name and nothing else. All that it has comes from libunderstudy.so, which it needs.
