import pytest

from exporters.step.canonical import canonical

HEAD = "ISO-10303-21;\nHEADER;\nFILE_NAME('a;b #1','');\nENDSEC;\nDATA;\n"
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"

# Two curves and two colours; the second file has other numbers, another order of colours and another counter.
FIRST = """#1 = SHAPE('a #9; ''quoted''',(#2,#3),#4);
#2 = CURVE('',1.);
#3 = CURVE('',
  2.);
#4 = CONTEXT('Context #1');
#5 = NEXT_ASSEMBLY_USAGE_OCCURRENCE('7','part','',#1);
#6 = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#7,#8),#4);
#7 = STYLED_ITEM('color',(#9),#2);
#8 = STYLED_ITEM('color',(#10),#3);
#9 = COLOUR('red');
#10 = COLOUR('green');
"""
SECOND = """#11 = SHAPE('a #9; ''quoted''',(#12,#13),#14);
#12 = CURVE('',1.);
#13 = CURVE('',2.);
#14 = CONTEXT('Context #1');
#15 = NEXT_ASSEMBLY_USAGE_OCCURRENCE('52','part','',#11);
#16 = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#17,
    #18),#14);
#17 = STYLED_ITEM('color',(#19),#13);
#18 = STYLED_ITEM('color',(#20),#12);
#19 = COLOUR('green');
#20 = COLOUR('red');
"""
CANONICAL = """#1=NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','part','',#2);
#2=SHAPE('a #9; ''quoted''',(#3,#4),#5);
#3=CURVE('',1.);
#4=CURVE('',2.);
#5=CONTEXT('Context #1');
#6=MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#7,#9),#5);
#7=STYLED_ITEM('color',(#8),#4);
#8=COLOUR('green');
#9=STYLED_ITEM('color',(#10),#3);
#10=COLOUR('red');
"""


@pytest.mark.parametrize("data", [FIRST, SECOND])
def test_order_numbers_and_counter_do_not_matter(data):
    assert canonical(HEAD + data + TAIL) == HEAD + CANONICAL + TAIL


def test_the_canonical_text_is_its_own_canonical_text():
    assert canonical(HEAD + CANONICAL + TAIL) == HEAD + CANONICAL + TAIL


def test_another_colour_is_another_text():
    swapped = FIRST.replace("(#9),#2", "(#10),#2").replace("(#10),#3", "(#9),#3")
    assert canonical(HEAD + swapped + TAIL) != HEAD + CANONICAL + TAIL


def test_the_order_of_the_lists_of_styles_does_not_matter():
    colours = """#6 = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#7),#4);
#7 = STYLED_ITEM('color',(#9),#{one});
#8 = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#11),#4);
#11 = STYLED_ITEM('color',(#9),#{two});
#9 = COLOUR('red');
"""
    shape = "".join(line + "\n" for line in FIRST.splitlines()[:6])
    one, two = (shape + colours.format(one=a, two=b) for a, b in ((2, 3), (3, 2)))
    assert canonical(HEAD + one + TAIL) == canonical(HEAD + two + TAIL)
