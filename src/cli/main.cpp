#include <cstdio>
int main() { std::puts("nacre"); }
