struct Unused {
    void* anything;
};
struct Holder {
    char* name;
};
