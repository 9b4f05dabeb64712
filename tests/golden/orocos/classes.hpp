struct Interface {
    virtual ~Interface();
    int number;
};
struct Left {
    int same;
};
struct Right {
    int same;
};
struct Both : Left, Right {
    int own;
};
struct Hidden : private Left {
    int own;
};
struct Diamond : virtual Left {
    int own;
};
enum class Large : unsigned long long { MOST = 18446744073709551615ull };
enum Wide { TOP = 0xffffffff };
