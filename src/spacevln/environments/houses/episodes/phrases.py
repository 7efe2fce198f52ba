"""How clauses are worded. Two tables with the same forms and no phrase in common: one to tune on, one to test on.

Phrases start with a verb in the imperative, so that they can be joined by "and", "then" or a full stop; ``once:`` and ``until:``
forms are finite clauses without their conjunction; ``:same`` forms name a room that was just named.
Slots: side, lm, a_lm, lm2, space, space_bare, space2, door, a_door, ord, stairs.
"""

from __future__ import annotations

from types import MappingProxyType

from spacevln.environments.houses.episodes.episode import Split

Table = MappingProxyType[str, tuple[str, ...]]


def _table(text: str) -> Table:
    """``form = phrase / phrase`` per line; an indented line continues the one before."""
    lines = text.strip().replace("\n  ", " ").splitlines()
    rows = (line.split("=", 1) for line in lines)
    return MappingProxyType({form.strip(): tuple(p.strip() for p in phrases.split("/")) for form, phrases in rows})


DEV = _table(
    """
turn = turn {side}
take_turn = take a {side} / make a {side} / take a {side} turn
take_turn_at = take a {side} at {lm} / make a {side} at {lm}
turn_at = turn {side} at {lm} / turn {side} by {lm} / turn {side} when you get to {lm}
turn_down = turn {side} down {space} / turn {side} and walk down {space} / go {side} down {space}
turn_into = turn {side} into {space} / go {side} into {space} / turn {side} to enter {space}
slight = turn slightly {side} / veer {side} / make a slight {side}
sharp = take a sharp {side} / make a sharp {side} turn
around = turn around
straight = walk straight / go straight / walk forward / walk straight ahead
straight_past = walk straight past {lm} / go straight past {lm} / continue straight past {lm}
straight_through = walk straight through {door} / go straight through {door}
straight_into = walk straight into {space} / go straight into {space}
hall = walk down {space} / go straight down {space} / continue walking down {space} / continue down {space}
hall_end = walk to the end of {space} / go down {space} to the end / walk all the way down {space}
through_space = walk through {space} / go straight through {space} / continue through {space} / walk all the way through {space}
across_space = walk across {space} / cross {space} / go across {space}
past = walk past {lm} / go past {lm} / continue walking past {lm} / continue past {lm}
over = walk over {lm} / walk across {lm} / go over {lm}
past_side = walk past {lm} on your {side} / pass {lm} on the {side} / go past {lm} on your {side}
side_of = walk to the {side} of {lm} / go to the {side} of {lm} / walk along the {side} side of {lm}
around_thing = walk around {lm} / go around {lm}
along_thing = walk along {lm} / walk alongside {lm}
between = walk between {lm} and {lm2} / go between {lm} and {lm2}
toward = walk towards {lm} / walk to {lm} / go to {lm} / walk toward {lm} / head towards {lm}
go_to_space = walk to {space} / go to {space} / walk over to {space}
there_is = you will see {a_lm} on your {side} / there is {a_lm} on the {side}
with_behind = with {lm} behind you, walk forward / stand with {lm} behind you
facing = face {lm} / start facing {lm}
with_side = with {lm} on your {side}, walk forward / stand with {lm} on your {side}
exit = exit {space} / walk out of {space} / leave {space} / go out of {space}
exit_through = exit {space} through {door} / leave {space} through {door} / walk out of {space} through {door}
exit_into = exit {space} into {space2} / walk out of {space} into {space2}
enter = enter {space} / walk into {space} / go into {space} / continue into {space}
through_door = walk through {door} / go through {door} / step through {door}
door_side = go through {door} on the {side} / walk through {door} on your {side} / enter {door} to the {side}
room_side = enter {space} on the {side} / walk into {space} on your {side} / go into {space} to the {side}
ordinal_door = enter the {ord} {door} on the {side} / go through the {ord} {door} on your {side} /
  walk to and through the {ord} {door} on the {side}
ordinal_turn = take the {ord} {side} / take your {ord} {side}
next_room = walk into the next room / enter the next room / go into the next room
stairs_up = go up the {stairs} / walk up the {stairs} / climb the {stairs}
stairs_down = go down the {stairs} / walk down the {stairs} / descend the {stairs}
stop_near = stop next to {lm} / wait by {lm} / stop near {lm} / wait right next to {lm} / stop right by {lm} / wait near {lm}
stop_at = stop at {lm} / wait at {lm}
stop_front = stop in front of {lm} / wait in front of {lm} / stand in front of {lm}
stop_near_both = stop by {lm} near {lm2} / wait next to {lm} close to {lm2}
stop_once_reach = stop when you reach {lm} / stop once you reach {lm}
stop_here = stop / wait there / stop there / wait here
stop_in = stop in {space} / wait in {space}
stop_inside = stop just inside {space} / wait just inside {space}
stop_once_in = stop once you are in {space} / stop when you enter {space} / stop as soon as you enter {space}
through_it = walk through it / go across it
stop_in:same = stop inside / wait in there / stop in there
stop_inside:same = stop just inside / wait just inside the door
stop_once_in:same = stop once you are inside / stop as soon as you are in
stop_doorway_of:same = stop in {door} / wait in {door}
stop_doorway = stop in {door} / wait in {door} / stand in {door}
stop_doorway_of = stop in {door} of {space} / wait in {door} to {space}
stop_door = stop at {door} / wait at {door} / stop by {door}
stop_door_to = stop at {door} to {space} / wait by {door} to {space}
stop_door_side = stop at {door} on the {side} / wait by {door} on your {side}
stop_outside = stop outside {space} / wait outside of {space} / wait just outside {space}
stop_before_space = stop before you enter {space} / stop before entering {space}
stop_top = stop at the top of the stairs / wait at the top of the stairs
stop_bottom = stop at the bottom of the stairs / wait at the bottom of the stairs
stop_before_stairs = stop before you get to the stairs / stop once you reach the stairs
stop_end = stop at the end of {space} / wait at the end of {space}
once:exit = you exit {space} / you leave {space} / you are out of {space}
once:enter = you enter {space} / you are in {space}
once:past = you pass {lm} / you are past {lm}
once:through_door = you go through {door} / you walk through {door}
once:stairs_up = you reach the top of the {stairs} / you get up the {stairs}
once:stairs_down = you reach the bottom of the {stairs} / you get down the {stairs}
once:hall_end = you reach the end of {space} / you get to the end of {space}
once:through_space = you cross {space} / you walk through {space}
until:enter = you reach {space} / you get to {space} / you enter {space}
until:toward = you reach {lm} / you get to {lm}
until:go_to_space = you reach {space} / you come to {space}
until:through_door = you go through {door} / you walk through {door}
"""
)

TEST = _table(
    """
turn = turn to the {side} / turn to your {side} / go {side}
take_turn = hang a {side} / make a {side} turn / make a {side} hand turn
take_turn_at = hang a {side} at {lm} / make a {side} turn at {lm} / take a {side} turn at {lm}
turn_at = turn to the {side} at {lm} / go {side} at {lm} / turn {side} once you are at {lm} / turn {side} before {lm}
turn_down = take a {side} down {space} / turn {side} and go down {space} / turn {side} and head down {space}
turn_into = take a {side} into {space} / turn {side} and enter {space} / make a {side} into {space}
slight = bear {side} / turn a little {side} / take a slight {side} / go slightly {side}
sharp = turn sharply to the {side} / take a hard {side}
around = turn all the way around / make a u-turn / do a 180
straight = keep going straight / continue straight / go forward / go straight ahead / continue forward
straight_past = keep going straight past {lm} / head straight past {lm} / walk straight ahead past {lm}
straight_through = continue straight through {door} / head straight through {door}
straight_into = continue straight into {space} / head straight into {space}
hall = head down {space} / follow {space} / proceed down {space} / go along {space}
hall_end = go all the way to the end of {space} / walk down {space} until the end / continue to the end of {space}
through_space = head through {space} / pass through {space} / make your way through {space}
across_space = head across {space} / continue across {space} / walk to the other side of {space}
past = head past {lm} / move past {lm} / walk by {lm} / keep walking past {lm} / go by {lm}
over = head across {lm} / walk straight over {lm} / step over {lm} / cross {lm}
past_side = pass {lm} to your {side} / walk past {lm} to the {side} / head past {lm} on the {side}
side_of = pass to the {side} of {lm} / stay to the {side} of {lm} / keep to the {side} of {lm}
around_thing = head around {lm} / make your way around {lm} / move around {lm}
along_thing = follow {lm} / go along {lm} / move along the side of {lm}
between = pass between {lm} and {lm2} / head between {lm} and {lm2}
toward = go towards {lm} / head toward {lm} / go over to {lm} / walk over to {lm} / move towards {lm}
go_to_space = head to {space} / make your way to {space} / continue to {space}
there_is = there will be {a_lm} on your {side} / you should see {a_lm} to the {side}
with_behind = with your back to {lm}, go forward / put {lm} behind you / start with {lm} behind you
facing = turn to face {lm} / stand facing {lm}
with_side = keeping {lm} on your {side}, go forward / start with {lm} to your {side}
exit = get out of {space} / head out of {space} / step out of {space} / make your way out of {space}
exit_through = go out of {space} through {door} / head out of {space} through {door} / exit {space} using {door}
exit_into = leave {space} and enter {space2} / go out of {space} into {space2} / head out of {space} into {space2}
enter = head into {space} / step into {space} / continue on into {space} / walk straight on into {space} / proceed into {space}
through_door = head through {door} / continue through {door} / pass through {door}
door_side = head through {door} on the {side} / take {door} on your {side} / go in {door} to your {side}
room_side = head into {space} on the {side} / go in {space} on your {side} / step into {space} on the {side}
ordinal_door = take the {ord} {door} on your {side} / head through the {ord} {door} on the {side} /
  go in the {ord} {door} to the {side}
ordinal_turn = make the {ord} {side} / turn at the {ord} {side}
next_room = continue into the next room / head into the next room / go on to the next room
stairs_up = head up the {stairs} / take the {stairs} up / go upstairs using the {stairs} / continue up the {stairs}
stairs_down = head down the {stairs} / take the {stairs} down / go downstairs using the {stairs} / continue down the {stairs}
stop_near = stop beside {lm} / wait beside {lm} / stop close to {lm} /
  stand next to {lm} / stop right beside {lm} / wait just next to {lm}
stop_at = stop right at {lm} / stop and wait at {lm}
stop_front = stop right in front of {lm} / stop facing {lm} / stop and wait in front of {lm} / wait just in front of {lm}
stop_near_both = stop beside {lm} near {lm2} / wait by {lm} next to {lm2}
stop_once_reach = stop as soon as you get to {lm} / wait once you get to {lm}
stop_here = stop here / stop and wait / wait / stop and wait there
stop_in = stop inside {space} / wait inside {space} / stop and wait in {space}
stop_inside = stop right inside {space} / wait right inside {space} / stop a step inside {space}
stop_once_in = stop once you get inside {space} / wait once you enter {space} / stop once you enter {space}
through_it = head through it / go straight through it
stop_in:same = stop in the room / wait inside / stop and wait inside
stop_inside:same = stop right inside / wait right inside the door
stop_once_in:same = stop once you get inside / wait as soon as you are inside
stop_doorway_of:same = stop right in {door} / wait inside {door}
stop_doorway = stop right in {door} / stop and wait in {door} / wait inside {door}
stop_doorway_of = stand in {door} of {space} / stop in {door} to {space} / wait in {door} of {space}
stop_door = stop near {door} / wait near {door} / wait by {door}
stop_door_to = stop by {door} to {space} / wait at {door} to {space} / stop near {door} of {space}
stop_door_side = stop near {door} on the {side} / wait at {door} to your {side}
stop_outside = stop just outside {space} / wait right outside {space} / stop right outside of {space}
stop_before_space = stop right before {space} / wait before entering {space}
stop_top = stop once you reach the top of the stairs / stand at the top of the stairs / stop at the top step
stop_bottom = stop at the foot of the stairs / stand at the bottom of the stairs / wait at the base of the stairs
stop_before_stairs = stop right before the stairs / stop when you come to the stairs
stop_end = stop at the far end of {space} / stand at the end of {space} / stop when you reach the end of {space}
once:exit = you get out of {space} / you have left {space} / you walk out of {space}
once:enter = you get into {space} / you walk into {space} / you are inside {space}
once:past = you walk past {lm} / you have passed {lm} / you go past {lm}
once:through_door = you get through {door} / you are through {door}
once:stairs_up = you get to the top of the {stairs} / you are at the top of the {stairs}
once:stairs_down = you get to the bottom of the {stairs} / you are at the bottom of the {stairs}
once:hall_end = you come to the end of {space} / you are at the end of {space}
once:through_space = you get across {space} / you have crossed {space}
until:enter = you are inside {space} / you come into {space} / you arrive in {space}
until:toward = you come to {lm} / you are at {lm}
until:go_to_space = you arrive at {space} / you are at {space}
until:through_door = you get through {door} / you pass through {door}
"""
)

PHRASES: MappingProxyType[Split, Table] = MappingProxyType({"dev": DEV, "test": TEST})
