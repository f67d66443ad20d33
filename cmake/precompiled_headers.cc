// SPDX-License-Identifier: Apache-2.0
// The program whose precompiled headers other programs reuse.
int main() {}
