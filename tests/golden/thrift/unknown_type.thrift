struct S {
  1: i32 a;
  2: Colour b;
}
enum Color { RED }
