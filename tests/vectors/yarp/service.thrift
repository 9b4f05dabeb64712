typedef i32 (yarp.type = "yarp::conf::vocab32_t") vocab
typedef double (yarp.type = "yarp::conf::float32_t") float32

enum Mode { IDLE = 0, RUN = 5 }

struct Inner { 1: i32 a; 2: double b; }

struct All {
  1: bool f; 2: i8 i; 3: i16 j; 4: i32 k; 5: i64 l; 6: double d; 7: string s; 8: binary blob; 9: Mode m; 10: vocab v; 11: float32 g;
  12: list<double> ld; 13: list<i32> li; 14: list<string> ls; 15: list<bool> lb; 16: list<Inner> lst; 17: map<string, double> mp;
  18: set<i32> st; 19: Inner inn; 20: Inner nest (yarp.nested = "true"); 21: list<list<double>> lld; 22: list<Mode> lm;
}

service Svc {
  bool set_pos(1: i32 joint, 2: double pos);
  list<double> get_encs();
  string hello(1: string name);
  oneway void fire(1: i32 x);
  All echo(1: All a);
}
