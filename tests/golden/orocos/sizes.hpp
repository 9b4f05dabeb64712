struct Long {
    double numbers[1000000000];
    int none[0];
};
struct alignas(4096) Sparse {
    char one;
};
struct Huge {
    double numbers[1000][1000][1000];
};
