#include <stdio.h>

extern "C" void draw();

int main() {
  draw();
  puts("done");
}
