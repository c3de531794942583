# Makes the bitstream: vivado -mode batch -source build.tcl [-tclargs STRATEGY], in this directory or from anywhere. Non-project flow; results in
# build/, those of another strategy than default in build/STRATEGY/.
#
# Fails where a step fails or has a critical warning that is not tolerated below, where a constraint names what is not there, where a memory
# image is missing, and where a report at the end lists something unsafe, unconstrained, too slow or misplaced, or has an unknown form.

# Critical warnings that may be, and rules of report_methodology and report_drc, as {ID reason}. None is known to be needed.
set tolerated {
}
# Messages that are errors here whatever Vivado calls them, by the folder of the file that they name: an image that was not opened, an object
# of a constraint that was not found, a line that is no constraint.
set errors {
    rtl {{Synth 8-4445}}
    constraints {
        {Vivado 12-180} {Vivado 12-507} {Vivado 12-508} {Vivado 12-584} {Vivado 12-627} {Vivado 12-4739} {Vivado 12-1387}
        {Common 17-55} {Designutils 20-1307}
    }
}

# Directives of placing and routing (UG904), by the name of the strategy: `make strategies` runs all of them and keeps the best.
set strategies {
    default {place_design {} phys_opt_design {} route_design {}}
    explore {place_design Explore phys_opt_design AggressiveExplore route_design AggressiveExplore}
    wires {place_design ExtraNetDelay_high phys_opt_design AggressiveExplore route_design NoTimingRelaxation}
}

set here [file dirname [file normalize [info script]]]
source [file join $here reports.tcl]
set part xc7k325tffg900-2

proc fail {reason} {
    puts stderr "build.tcl: $reason"
    exit 1
}

set strategy [expr {[llength $argv] > 0 ? [lindex $argv 0] : "default"}]
if {[llength $argv] > 1 || ![dict exists $strategies $strategy]} {
    fail "strategy '$argv': expected one of [join [dict keys $strategies] {, }]"
}
set out [file join $here build]
if {$strategy ne "default"} { set out [file join $out $strategy] }
file mkdir $out
file delete {*}[glob -nocomplain -directory $out edof*.bit strategy.txt]

# The step of placing or routing with the strategy's directive.
proc directed {command} {
    global strategies strategy
    set directive [dict get $strategies $strategy $command]
    step $command {*}[expr {$directive eq "" ? {} : [list -directive $directive]}]
}

# A step of the flow; critical warnings that came with it fail it.
proc step {args} {
    uplevel #0 $args
    critical [lindex $args 0]
}

proc critical {step} {
    global tolerated
    set found [get_msg_config -severity {CRITICAL WARNING} -count]
    foreach entry $tolerated {
        # The ID of a message has two words, a rule has one.
        if {[llength [lindex $entry 0]] == 2} { incr found -[get_msg_config -id [lindex $entry 0] -count] }
    }
    if {$found > 0} { fail "$step: $found critical warnings, see above; what may be belongs into the list tolerated" }
}

proc files {pattern} {
    global here
    return [lsort [glob -directory $here $pattern]]
}

proc contents {file} {
    set channel [open $file]
    set text [read $channel]
    close $channel
    return $text
}

# Writes a report to build/ and fails where its reader finds a violation or does not know its form.
proc check {file command reader args} {
    global out
    set text [uplevel #0 [list {*}$command -return_string]]
    set channel [open [file join $out $file] w]
    puts $channel $text
    close $channel
    if {![catch {$reader $text {*}$args} violations]} { set violations [join $violations {; }] }
    if {$violations ne ""} { fail "[lindex $command 0]: $violations: see build/$file" }
}

# Cells of a module; Vivado merely warns of a pattern without a match.
proc cells_of {module} {
    set found [get_cells -hierarchical -filter "ORIG_REF_NAME =~ $module* || REF_NAME =~ $module*"]
    if {[llength $found] == 0} { fail "no $module is in the netlist" }
    return $found
}

# Vivado would go on without a memory image, with zeros in its place.
if {[file exists [file join $here manifest.json]]} {
    foreach {entry path} [regexp -all -inline {"path": "(mem/[^"]+)"} [contents [file join $here manifest.json]]] {
        if {![file exists [file join $here $path]]} { fail "$path: this memory image is missing; generate the directory again" }
    }
}

create_project -in_memory -part $part
dict for {folder ids} $errors {
    foreach id $ids { set_msg_config -id $id -string [list [file join $here $folder]/] -new_severity ERROR }
}
# The DRAM controller's own constraints raise critical warnings in every build; these stay visible as warnings.
set_msg_config -severity {CRITICAL WARNING} -string [list [file join $out mig_kc705]/] -new_severity WARNING
set_property target_language Verilog [current_project]
set_property default_lib work [current_project]

# The DRAM controller, from its project file; anew where an earlier run left one.
step create_ip -name mig_7series -vendor xilinx.com -library ip -module_name mig_kc705 -dir $out -force
set_property -dict [list CONFIG.XML_INPUT_FILE [file join $here constraints mig.prj] \
    CONFIG.RESET_BOARD_INTERFACE Custom CONFIG.MIG_DONT_TOUCH_PARAM Custom CONFIG.BOARD_MIG_PARAM Custom] [get_ips mig_kc705]
step generate_target all [get_ips mig_kc705]
step synth_ip [get_ips mig_kc705]

# Memory images are found by their names among the files of the project.
step read_verilog [files rtl/*.v]
step read_mem [files mem/*.mem]
step read_xdc [file join $here constraints kc705.xdc]
step synth_design -top kc705_top -part $part -flatten_hierarchy rebuilt -verilog_define EDOF_IMAGES_BY_NAME -verilog_define SYNTHESIS
# To what synthesis left, so that each limit holds what is there.
set limits_file [file join $here constraints crossings.xdc]
step read_xdc $limits_file
# Each synchroniser of the core is the end of one of its lines: Vivado would not say so where its input has an exception, too.
set limits [contents $limits_file]
foreach cell [cells_of edof_sync] {
    set name [get_property NAME $cell]
    if {[string match core/* $name] && [string first "$name/first_q_reg" $limits] < 0} {
        fail "$name: no line of crossings.xdc ends at this synchroniser; generate the directory again"
    }
}
write_checkpoint -force [file join $out synthesised.dcp]
report_utilization -hierarchical -file [file join $out synthesised_utilization.rpt]

step opt_design
directed place_design
directed phys_opt_design
directed route_design
directed phys_opt_design
write_checkpoint -force [file join $out routed.dcp]

check utilization.rpt {report_utilization} utilization_violations
# Each pair of unrelated clocks has an exception for all of its paths.
check clocks.rpt {report_clock_interaction} clock_violations
report_power -file [file join $out power.rpt]
report_timing_summary -file [file join $out timing.rpt]

# The worst paths between all clocks. Only those inside of the calculator's clock may miss it: the design then works at a lower rate.
set calculator [get_clocks -of_objects [get_pins calculator_mmcm/CLKOUT0]]
if {[llength $calculator] != 1} { fail "the calculator's clock at calculator_mmcm/CLKOUT0 is '$calculator', expected one clock" }
set timed {setup 0 hold 0}
set slack_of {setup inf hold inf}
set holds_mhz ""
foreach from [get_clocks] {
    foreach to [get_clocks] {
        foreach kind {setup hold} {
            set paths [get_timing_paths -max_paths 1 -$kind -from $from -to $to]
            if {[llength $paths] == 0} { continue }
            dict incr timed $kind
            set slack [get_property SLACK [lindex $paths 0]]
            dict set slack_of $kind [expr {min([dict get $slack_of $kind], $slack)}]
            if {$slack >= 0} { continue }
            if {$kind eq "hold" || $from ne $calculator || $to ne $calculator} {
                fail "the worst $kind slack from [get_property NAME $from] to [get_property NAME $to] is $slack ns, below zero: see build/timing.rpt"
            }
            set holds_mhz [expr {int(floor(1000.0 / ([get_property REQUIREMENT [lindex $paths 0]] - $slack)))}]
        }
    }
}
dict for {kind count} $timed {
    if {$count == 0} { fail "no $kind path was timed: are the clocks constrained?" }
    puts "worst $kind slack: [dict get $slack_of $kind] ns"
}

# What no clock reaches and no delay limits; ports without a delay on purpose are those that kc705.xdc excepts.
check unconstrained.rpt {check_timing -verbose} timing_violations [excepted_ports [contents [file join $here constraints kc705.xdc]]]
# Every Gray-coded pointer has a limit of its skew, and keeps it.
check bus_skew.rpt {report_bus_skew} skew_violations [expr {2 * [llength [cells_of edof_async_fifo]]}]
check pulse_width.rpt {report_pulse_width} pulse_violations

# Crossings of ours; those inside of the controller are its maker's.
report_cdc -details -file [file join $out cdc.rpt]
set core [get_cells core]
if {[llength $core] != 1} { fail "no cell core is in the netlist" }
check cdc_core.rpt [list report_cdc -details -cells $core] crossing_violations

set rules [lmap entry $tolerated { lindex $entry 0 }]
check methodology.rpt {report_methodology} rule_violations "Report Methodology" $rules

# Pixels are registered in the pads.
set pads [get_cells -hierarchical -filter {IOB == TRUE}]
if {[llength $pads] == 0} { fail "no register asks for a place in a pad" }
foreach cell $pads {
    if {![regexp {^[IO]LOGIC} [get_property LOC $cell]]} { fail "[get_property NAME $cell] is at [get_property LOC $cell], expected in its pad" }
}
# The receiver's data pass the zero-hold delay of their pads, for which the input's budget is calculated.
foreach port [get_ports {hdmi_rx_data[*]}] {
    set delay [get_property IOBDELAY $port]
    if {$delay ne "IFD"} { fail "the input delay of [get_property NAME $port] is '$delay', expected IFD (constraints/kc705.xdc)" }
}
# Banks 32 and 34 of the DRAM have no resistors of their own.
set cascade [get_property DCI_CASCADE [get_iobanks 33]]
if {[lsort $cascade] ne {32 34}} { fail "bank 33 gives its impedance to banks '$cascade', expected 32 and 34" }

set_property SEVERITY {Error} [get_drc_checks CFGBVS-1]
check drc.rpt {report_drc} rule_violations "Report DRC" $rules
set_property BITSTREAM.GENERAL.COMPRESS TRUE [current_design]
# A bitstream that misses its clock has a name of its own, so that nobody takes it for the other.
set bitstream [expr {$holds_mhz eq "" ? "edof.bit" : "edof-holds-${holds_mhz}mhz.bit"}]
step write_bitstream -force [file join $out $bitstream]
set channel [open [file join $out strategy.txt] w]
puts $channel "$strategy [dict get $slack_of setup] [dict get $slack_of hold] $bitstream"
close $channel
if {$holds_mhz ne ""} {
    fail "the calculator holds $holds_mhz MHz, its worst setup slack is [dict get $slack_of setup] ns: $bitstream is for trials alone; set clock_mhz of the design to\
$holds_mhz or less and generate again, or try `make strategies`"
}
puts "$bitstream is done: openFPGALoader -b kc705 [file join $out $bitstream]"
