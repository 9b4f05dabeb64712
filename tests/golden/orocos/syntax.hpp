struct A {
    int x
    unknown y;
};
