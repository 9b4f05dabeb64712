#include <string>
#include <vector>
#include "lib/holder.hpp"

union Either { int a; float b; };
struct Later;
template <class T> struct Box { T content; };

struct Wrong {
    double* pointer;
    int& reference;
    unsigned bits : 3;
    long double wide;
    wchar_t letter;
    std::wstring text;
    Either either;
    Box<int> box;
    std::vector<Later> later;
    union { int x; };
    struct { int* inner; } unnamed;
    __int128 huge;
    void (*call)();
    Holder holder;

  private:
    int secret;
};
